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

SessionParams with_trigger(drivers::TriggerSource trigger, SessionParams params) {
  params.trigger = trigger;
  return params;
}

}  // namespace

SessionParams with_port_reset(const std::string& uri, SessionParams params) {
  const std::string serial = usb_serial_of(uri);
  if (!serial.empty() && !params.recover)
    params.recover = [serial](bool in_use) { drivers::reset_usb_port(serial, in_use); };
  return params;
}

ArrivalWatch::ArrivalWatch(const std::string& uri, SensorSession& session) {
  const std::string serial = usb_serial_of(uri);
  if (serial.empty()) return;
  try {
    watcher_ =
        std::make_unique<drivers::UsbWatcher>([&session, serial](const drivers::UsbEvent& e) {
          if (e.arrived && e.sensor.serial == serial) session.retry_now();
        });
  } catch (const drivers::SensorError& e) {
    fault_ = e.what();
  }
}

LiveSensor::LiveSensor(const drivers::CameraSpec& spec, FramePool& pool, SessionParams params)
    : session_([spec] { return drivers::open_camera(spec); }, pool,
               with_port_reset(spec.uri, with_trigger(spec.trigger, std::move(params)))),
      arrivals_(spec.uri, session_) {}

}  // namespace binpick::app
