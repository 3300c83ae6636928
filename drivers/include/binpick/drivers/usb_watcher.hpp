// Tells when USB3 Vision sensors arrive at the bus and leave it. The callback runs on the watcher's
// own thread, one call at a time, and has to return soon; it must not throw nor end the watcher.
// Thread: made and destroyed by one.
#pragma once

#include <functional>
#include <memory>

#include "binpick/drivers/usb_bus.hpp"

namespace binpick::drivers {

struct UsbEvent {
  bool arrived = false;  // false: left
  UsbSensor sensor;      // of one that left: as it was when it arrived
};

class UsbWatcher {
 public:
  using Callback = std::function<void(const UsbEvent&)>;

  // Sensors that are there already are not told. Throws SensorError where the system tells no
  // events.
  explicit UsbWatcher(Callback callback);
  // Afterwards the callback is not called any more.
  ~UsbWatcher();
  UsbWatcher(const UsbWatcher&) = delete;
  UsbWatcher& operator=(const UsbWatcher&) = delete;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace binpick::drivers
