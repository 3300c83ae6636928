// A session on the sensor that a spec names, with what a sensor on the USB bus needs beside it: its
// arrival at the bus ends the pause before the next attempt to open it, and where attempts keep
// failing its port is reset as the last resort.
// Thread-safe, as the session is; made and destroyed by one.
#pragma once

#include <memory>
#include <string>

#include "binpick/drivers/camera_spec.hpp"
#include "binpick/drivers/usb_watcher.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::app {

class LiveSensor {
 public:
  // The trigger is the spec's. A `recover` of the params takes the place of the port's reset.
  LiveSensor(const drivers::CameraSpec& spec, FramePool& pool, SessionParams params);
  LiveSensor(const LiveSensor&) = delete;
  LiveSensor& operator=(const LiveSensor&) = delete;

  SensorSession& session() { return session_; }
  // Why arrivals are not noticed, so that only the back-off finds a returned sensor; empty: they
  // are, or the sensor is not on the USB bus.
  const std::string& watch_fault() const { return watch_fault_; }

 private:
  SensorSession session_;
  std::string watch_fault_;
  std::unique_ptr<drivers::UsbWatcher> watcher_;  // after the session, which it calls
};

}  // namespace binpick::app
