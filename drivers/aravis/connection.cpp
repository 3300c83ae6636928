#include "aravis/connection.hpp"

#include <string_view>

#include "binpick/drivers/camera.hpp"

namespace binpick::drivers {
namespace {

constexpr std::string_view kSerial = "serial/";

// What Aravis calls the device with this serial number. Looks at the whole network: a second.
std::string device_id_of(const std::string& uri, std::string_view serial, bool usb) {
  arv_update_device_list();
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    const char* found = arv_get_device_serial_nbr(i);
    const char* protocol = arv_get_device_protocol(i);
    if (found == nullptr || protocol == nullptr || serial != found) continue;
    if (std::string_view(protocol) == (usb ? "USB3Vision" : "GigEVision"))
      return arv_get_device_id(i);
  }
  throw SensorError(uri + ": no sensor with this serial number was found");
}

}  // namespace

GObjectPtr<ArvCamera> connect_sensor(const std::string& uri) {
  const bool usb = uri.starts_with("u3v://");
  const std::string_view place = std::string_view(uri).substr(6);
  std::string id(place);
  if (place.starts_with(kSerial)) {
    id = device_id_of(uri, place.substr(kSerial.size()), usb);
  } else if (usb) {
    throw SensorError(uri + ": expected u3v://serial/NUMBER");
  }
  CaughtError error;
  GObjectPtr<ArvCamera> camera(arv_camera_new(id.c_str(), error.out()));
  if (!camera) {
    throw SensorError(uri + ": cannot be opened" +
                      (error ? std::string(" (") + error.message() + ")" : std::string()));
  }
  return camera;
}

}  // namespace binpick::drivers
