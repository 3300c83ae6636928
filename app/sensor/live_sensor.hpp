// What a session on the USB bus needs beside it: the sensor's arrival at the bus ends the pause
// before the next attempt to open it, and where attempts keep failing its port is reset as the last
// resort. For other sensors these do nothing. Thread-safe, as the session is; made and destroyed by
// one.
#pragma once

#include <memory>
#include <string>

#include "binpick/drivers/camera_spec.hpp"
#include "binpick/drivers/usb_watcher.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::app {

// The params with the reset of the sensor's port as their `recover`, unless they have one.
SessionParams with_port_reset(const std::string& uri, SessionParams params);

// Tells the session when its sensor comes to the bus. The session outlives it.
class ArrivalWatch {
 public:
  ArrivalWatch(const std::string& uri, SensorSession& session);

  // Why arrivals are not noticed, so that only the back-off finds a returned sensor; empty: they
  // are, or the sensor is not on the USB bus.
  const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
  std::unique_ptr<drivers::UsbWatcher> watcher_;
};

// A session on the sensor that a spec names, with both.
class LiveSensor {
 public:
  // The trigger is the spec's.
  LiveSensor(const drivers::CameraSpec& spec, FramePool& pool, SessionParams params);
  LiveSensor(const LiveSensor&) = delete;
  LiveSensor& operator=(const LiveSensor&) = delete;

  SensorSession& session() { return session_; }
  const std::string& watch_fault() const { return arrivals_.fault(); }

 private:
  SensorSession session_;
  ArrivalWatch arrivals_;
};

}  // namespace binpick::app
