// libusb's objects with owners, and what is read of one device.
// Thread: one at a time for each object.
#pragma once

#include <libusb.h>

#include <memory>
#include <optional>
#include <string>

#include "binpick/drivers/usb_bus.hpp"

namespace binpick::drivers {

struct UsbContextEnd {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
using UsbContext = std::unique_ptr<libusb_context, UsbContextEnd>;
// Throws SensorError.
UsbContext make_usb_context();

struct UsbClose {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
using UsbHandle = std::unique_ptr<libusb_device_handle, UsbClose>;

struct UsbUnref {
  void operator()(libusb_device* device) const { libusb_unref_device(device); }
};
using UsbDeviceRef = std::unique_ptr<libusb_device, UsbUnref>;

class UsbDeviceList {
 public:
  explicit UsbDeviceList(libusb_context* context);  // throws SensorError
  ~UsbDeviceList() { libusb_free_device_list(devices_, 1); }
  UsbDeviceList(const UsbDeviceList&) = delete;
  UsbDeviceList& operator=(const UsbDeviceList&) = delete;

  libusb_device** begin() const { return devices_; }
  libusb_device** end() const { return devices_ + count_; }

 private:
  libusb_device** devices_ = nullptr;
  std::ptrdiff_t count_ = 0;
};

// What its descriptors say, without opening it.
struct U3vInterface {
  int control_number = 0;  // of the control interface
  bool super_speed_capable = true;
};
// Empty: no USB3 Vision device.
std::optional<U3vInterface> find_u3v_interface(libusb_device* device);

// Opens the device for a moment, to see whether it may be opened. Empty: no USB3 Vision device.
std::optional<UsbSensor> describe_usb_sensor(libusb_device* device);

// A sentence for a failure to open `node`.
std::string usb_open_fault(const std::string& node, int libusb_error);

}  // namespace binpick::drivers
