#include "sensor/live_sensor.hpp"

#include "binpick/drivers/open_camera.hpp"
#include "binpick/drivers/usb_bus.hpp"

namespace binpick::app {
namespace {

constexpr const char* kUsbSerial = "u3v://serial/";

// The serial number of a sensor on the USB bus; empty for others.
std::string usb_serial_of(const std::string& uri) {
  return uri.starts_with(kUsbSerial) ? uri.substr(std::string(kUsbSerial).size()) : "";
}

SessionParams session_params(const drivers::CameraSpec& spec, SessionParams params) {
  params.trigger = spec.trigger;
  const std::string serial = usb_serial_of(spec.uri);
  if (!serial.empty() && !params.recover)
    params.recover = [serial] { drivers::reset_usb_port(serial); };
  return params;
}

}  // namespace

LiveSensor::LiveSensor(const drivers::CameraSpec& spec, FramePool& pool, SessionParams params)
    : session_([spec] { return drivers::open_camera(spec); }, pool,
               session_params(spec, std::move(params))) {
  const std::string serial = usb_serial_of(spec.uri);
  if (serial.empty()) return;
  try {
    watcher_ = std::make_unique<drivers::UsbWatcher>([this, serial](const drivers::UsbEvent& e) {
      if (e.arrived && e.sensor.serial == serial) session_.retry_now();
    });
  } catch (const drivers::SensorError& e) {
    watch_fault_ = e.what();
  }
}

}  // namespace binpick::app
