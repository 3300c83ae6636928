#include "usb_descriptors.hpp"

namespace binpick::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kVendorString = 1, kProductString = 2, kSerialString = 3, kGuidString = 4;

std::uint8_t low(std::size_t value) {
  return static_cast<std::uint8_t>(value);
}
std::uint8_t high(std::size_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}

Bytes device_descriptor(bool usb2, std::uint8_t device_class, std::uint8_t subclass,
                        std::uint8_t protocol, std::uint16_t vendor, std::uint16_t product,
                        bool has_strings) {
  const auto string = [&](std::uint8_t index) { return has_strings ? index : std::uint8_t{0}; };
  return {18,
          1,
          usb2 ? std::uint8_t{0x10} : std::uint8_t{0},
          usb2 ? std::uint8_t{2} : std::uint8_t{3},
          device_class,
          subclass,
          protocol,
          usb2 ? std::uint8_t{64} : std::uint8_t{9},
          low(vendor),
          high(vendor),
          low(product),
          high(product),
          0,
          1,
          string(kVendorString),
          string(kProductString),
          string(kSerialString),
          1};
}

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append_endpoint(Bytes& bytes, std::uint8_t address, bool usb2) {
  append(bytes, {7, 5, address, 2, 0, usb2 ? std::uint8_t{2} : std::uint8_t{4}, 0});
  if (!usb2) append(bytes, {6, 0x30, 0, 0, 0, 0});  // super-speed companion
}

// The device info that stands behind the control interface: version 1.2 of the control protocol,
// 1.0 of USB3 Vision, and the strings.
const Bytes kDeviceInfo = {20,
                           0x24,
                           1,
                           2,
                           0,
                           1,
                           0,
                           0,
                           0,
                           1,
                           0,
                           kGuidString,
                           kVendorString,
                           kProductString,
                           0,
                           0,
                           0,
                           kSerialString,
                           0,
                           0x0c};

}  // namespace

Bytes camera_descriptors(bool usb2) {
  Bytes body;
  append(body, {8, 11, 0, 2, 0xef, 5, 0, 0});    // interface association
  append(body, {9, 4, 0, 0, 2, 0xef, 5, 0, 0});  // control
  append(body, kDeviceInfo);
  append_endpoint(body, kControlOut, usb2);
  append_endpoint(body, kControlIn, usb2);
  append(body, {9, 4, 1, 0, 1, 0xef, 5, 2, 0});  // stream
  append_endpoint(body, kStreamIn, usb2);
  const std::size_t size = 9 + body.size();
  Bytes all = device_descriptor(usb2, 0xef, 2, 1, kUsbVendor, kUsbProduct, true);
  append(all, {9, 2, low(size), high(size), 2, 1, 0, 0x80,
               usb2 ? std::uint8_t{250} : std::uint8_t{112}});
  append(all, body);
  return all;
}

Bytes hub_descriptors(bool usb2) {
  Bytes body = {9, 4, 0, 0, 1, 9, 0, 0, 0};
  append(body, {7, 5, 0x81, 3, 4, 0, 12});
  if (!usb2) append(body, {6, 0x30, 0, 0, 2, 0});
  const std::size_t size = 9 + body.size();
  Bytes all = device_descriptor(usb2, 9, 0, usb2 ? 1 : 3, 0x1d6b, usb2 ? 2 : 3, false);
  append(all, {9, 2, low(size), high(size), 1, 1, 0, 0xe0, 0});
  append(all, body);
  return all;
}

Bytes string_descriptor(int index, const SensorName& name) {
  std::string text;
  switch (index) {
    case 0:
      return {4, 3, 9, 4};  // English
    case kVendorString:
      text = name.vendor;
      break;
    case kProductString:
      text = name.model;
      break;
    case kSerialString:
      text = name.serial;
      break;
    case kGuidString:
      text = "1209" + name.serial;
      break;
    default:
      return {};
  }
  if (text.size() > 126) text.resize(126);
  Bytes bytes = {low(2 + 2 * text.size()), 3};
  for (const char c : text) append(bytes, {static_cast<std::uint8_t>(c), 0});
  return bytes;
}

}  // namespace binpick::sim
