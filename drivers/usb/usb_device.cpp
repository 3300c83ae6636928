#include "usb/usb_device.hpp"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <span>

#include "binpick/drivers/camera.hpp"

namespace binpick::drivers {
namespace {

// USB3 Vision: class "miscellaneous", and the numbers of control and stream within it.
constexpr int kMiscellaneous = 0xef, kUsb3Vision = 0x05, kControlProtocol = 0;
// The device info behind the control interface: its kind, and the place of the supported speeds.
constexpr std::uint8_t kClassInterface = 0x24, kDeviceInfo = 0x01;
constexpr std::size_t kSpeedsAt = 19;
constexpr std::uint8_t kAnySuperSpeed = 0x08 | 0x10;
constexpr int kPortsMax = 7;  // hubs in a row, as USB allows

struct ConfigFree {
  void operator()(libusb_config_descriptor* config) const { libusb_free_config_descriptor(config); }
};
using Config = std::unique_ptr<libusb_config_descriptor, ConfigFree>;

UsbSpeed speed_of(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW:
      return UsbSpeed::kLow;
    case LIBUSB_SPEED_FULL:
      return UsbSpeed::kFull;
    case LIBUSB_SPEED_HIGH:
      return UsbSpeed::kHigh;
    case LIBUSB_SPEED_SUPER:
      return UsbSpeed::kSuper;
    case LIBUSB_SPEED_SUPER_PLUS:
      return UsbSpeed::kSuperPlus;
    default:
      return UsbSpeed::kUnknown;
  }
}

std::string port_of(libusb_device* device) {
  std::uint8_t ports[kPortsMax];
  const int count = libusb_get_port_numbers(device, ports, kPortsMax);
  std::string path = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) {
    path += i == 0 ? '-' : '.';
    path += std::to_string(ports[i]);
  }
  return path;
}

std::string node_of(libusb_device* device) {
  char text[40];
  std::snprintf(text, sizeof text, "/dev/bus/usb/%03d/%03d", libusb_get_bus_number(device),
                libusb_get_device_address(device));
  return text;
}

// What the kernel has read of the device when it arrived: known also of a device that may not be
// opened, or that no longer answers.
std::string kernel_text(const std::string& port, const char* attribute) {
  std::string line;
  std::ifstream file("/sys/bus/usb/devices/" + port + "/" + attribute);
  std::getline(file, line);
  return line;
}

std::string device_text(libusb_device_handle* handle, std::uint8_t index) {
  unsigned char text[256];
  const int count =
      index == 0 ? 0 : libusb_get_string_descriptor_ascii(handle, index, text, sizeof text);
  return count <= 0 ? "" : std::string(text, text + count);
}

// Of a device that says nothing of its speeds, it is supposed that it is what its name says.
bool says_super_speed(std::span<const std::uint8_t> extra) {
  while (extra.size() >= 3 && extra[0] >= 3 && extra[0] <= extra.size()) {
    if (extra[1] == kClassInterface && extra[2] == kDeviceInfo && extra[0] > kSpeedsAt)
      return extra[kSpeedsAt] == 0 || (extra[kSpeedsAt] & kAnySuperSpeed) != 0;
    extra = extra.subspan(extra[0]);
  }
  return true;
}

}  // namespace

UsbContext make_usb_context() {
  libusb_context* context = nullptr;
  const int error = libusb_init(&context);
  if (error != 0) throw SensorError(std::string("USB: ") + libusb_strerror(error));
  return UsbContext(context);
}

UsbDeviceList::UsbDeviceList(libusb_context* context) {
  count_ = libusb_get_device_list(context, &devices_);
  if (count_ < 0)
    throw SensorError(std::string("USB: ") + libusb_strerror(static_cast<int>(count_)));
}

std::optional<U3vInterface> find_u3v_interface(libusb_device* device) {
  libusb_config_descriptor* raw = nullptr;
  if (libusb_get_config_descriptor(device, 0, &raw) != 0) return std::nullopt;
  const Config config(raw);
  for (const libusb_interface& interface : std::span(config->interface, config->bNumInterfaces)) {
    const auto settings =
        std::span(interface.altsetting, static_cast<std::size_t>(interface.num_altsetting));
    for (const libusb_interface_descriptor& setting : settings) {
      if (setting.bInterfaceClass != kMiscellaneous || setting.bInterfaceSubClass != kUsb3Vision ||
          setting.bInterfaceProtocol != kControlProtocol)
        continue;
      const std::span extra(setting.extra, static_cast<std::size_t>(setting.extra_length));
      return U3vInterface{setting.bInterfaceNumber, says_super_speed(extra)};
    }
  }
  return std::nullopt;
}

std::string usb_open_fault(const std::string& node, int libusb_error) {
  if (libusb_error != LIBUSB_ERROR_ACCESS)
    return node + " cannot be opened (" + libusb_strerror(libusb_error) + ")";
  return "this user may not open " + node +
         ": install firmware-config/udev/60-binpick-usb.rules, be a member of the group plugdev, "
         "and plug the sensor in again";
}

std::optional<UsbSensor> describe_usb_sensor(libusb_device* device) {
  const std::optional<U3vInterface> interface = find_u3v_interface(device);
  if (!interface) return std::nullopt;
  UsbSensor sensor;
  sensor.speed = speed_of(device);
  sensor.super_speed_capable = interface->super_speed_capable;
  sensor.port = port_of(device);
  sensor.node = node_of(device);
  sensor.vendor = kernel_text(sensor.port, "manufacturer");
  sensor.model = kernel_text(sensor.port, "product");
  sensor.serial = kernel_text(sensor.port, "serial");
  libusb_device_handle* raw = nullptr;
  const int error = libusb_open(device, &raw);
  if (error != 0) {
    sensor.access_fault = usb_open_fault(sensor.node, error);
    return sensor;
  }
  const UsbHandle handle(raw);
  libusb_device_descriptor descriptor;
  if (libusb_get_device_descriptor(device, &descriptor) != 0) return sensor;
  // Where the kernel has no such file.
  if (sensor.vendor.empty()) sensor.vendor = device_text(raw, descriptor.iManufacturer);
  if (sensor.model.empty()) sensor.model = device_text(raw, descriptor.iProduct);
  if (sensor.serial.empty()) sensor.serial = device_text(raw, descriptor.iSerialNumber);
  return sensor;
}

}  // namespace binpick::drivers
