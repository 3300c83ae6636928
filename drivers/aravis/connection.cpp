#include "aravis/connection.hpp"

#include <mutex>
#include <string_view>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/usb_bus.hpp"

namespace binpick::drivers {
namespace {

constexpr std::string_view kSerial = "serial/";

// What Aravis calls the device with this serial number. Looks at the whole network, which takes a
// second, or at the whole USB bus, which takes no time.
std::string device_id_of(ArvInterface* interface, const std::string& uri, std::string_view serial) {
  arv_interface_update_device_list(interface);
  for (unsigned i = 0; i < arv_interface_get_n_devices(interface); ++i) {
    const char* found = arv_interface_get_device_serial_nbr(interface, i);
    if (found != nullptr && serial == found) return arv_interface_get_device_id(interface, i);
  }
  // One on the bus that may not be opened is not in the list.
  const std::string fault =
      ARV_IS_UV_INTERFACE(interface) ? usb_access_fault(std::string(serial)) : "";
  throw SensorError(uri + ": " +
                    (fault.empty() ? "no sensor with this serial number was found" : fault));
}

}  // namespace

std::mutex& sensor_list_mutex(bool usb) {
  static std::mutex network, bus;
  return usb ? bus : network;
}

GObjectPtr<ArvCamera> connect_sensor(const std::string& uri) {
  const bool usb = uri.starts_with("u3v://");
  // The double is a program of its own, so that the whole way through the network is the sensor's.
  const bool simulated = uri == "sim:gev";
  const std::string_view place = simulated ? "127.0.0.1" : std::string_view(uri).substr(6);
  std::string id(place);
  ArvInterface* interface = usb ? arv_uv_interface_get_instance() : arv_gv_interface_get_instance();
  const std::lock_guard lock(sensor_list_mutex(usb));
  if (place.starts_with(kSerial)) {
    id = device_id_of(interface, uri, place.substr(kSerial.size()));
  } else if (usb) {
    throw SensorError(uri + ": expected u3v://serial/NUMBER");
  }
  CaughtError error;
  const GObjectPtr<ArvDevice> device(arv_interface_open_device(interface, id.c_str(), error.out()));
  GObjectPtr<ArvCamera> camera(device ? arv_camera_new_with_device(device.get(), error.out())
                                      : nullptr);
  if (!camera) {
    throw SensorError(uri + ": cannot be opened" +
                      (error ? std::string(" (") + error.message() + ")" : std::string()) +
                      (simulated ? "; start it first: gvsim --scenes DIR" : ""));
  }
  return camera;
}

void require_control(ArvCamera* camera, const std::string& uri) {
  ArvDevice* device = arv_camera_get_device(camera);
  if (!ARV_IS_GV_DEVICE(device) || arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return;
  if (!arv_gv_device_take_control(ARV_GV_DEVICE(device), nullptr))
    throw SensorError(uri + ": " + kControlledElsewhere);
}

}  // namespace binpick::drivers
