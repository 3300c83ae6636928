// A bus with one camera, under umockdev: what programs see that run with its library preloaded and
// UMOCKDEV_DIR set to its folder.
// Thread: one; the camera's calls are served on umockdev's own.
#pragma once

#include <umockdev.h>

#include <string>

#include "usbfs_emulation.hpp"

namespace binpick::sim {

struct UsbBusOptions {
  SensorName name;            // of the camera
  bool usb2 = false;          // its port
  int usbfs_memory_mib = 16;  // what the kernel lends for transfers; 16 is its default
};

class UsbTestbed {
 public:
  // Throws std::runtime_error when umockdev refuses.
  UsbTestbed(UsbfsEmulation& camera, const UsbBusOptions& options);
  ~UsbTestbed();
  UsbTestbed(const UsbTestbed&) = delete;
  UsbTestbed& operator=(const UsbTestbed&) = delete;

  const std::string& folder() const { return folder_; }
  bool plugged() const { return plugged_; }
  void plug();  // the bus gives a new number each time
  void unplug();

 private:
  std::string device_node() const;
  void add_device(const std::string& text);

  UsbfsEmulation& camera_;
  const SensorName name_;
  const bool usb2_;
  UMockdevTestbed* bed_;
  std::string folder_;
  bool plugged_ = false;
  int device_number_ = 1;  // the root hub has it
};

}  // namespace binpick::sim
