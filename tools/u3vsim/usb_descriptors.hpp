// The descriptors of a USB3 Vision camera, and of the root hub above it.
// Thread-safe: functions of their arguments.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sensor_xml.hpp"

namespace binpick::sim {

constexpr std::uint8_t kControlOut = 0x01, kControlIn = 0x81, kStreamIn = 0x82;
constexpr std::uint16_t kUsbVendor = 0x1209, kUsbProduct = 0x0001;  // pid.codes' for tests

// Device and configuration descriptor, as the kernel's "descriptors" attribute has them.
std::vector<std::uint8_t> camera_descriptors(bool usb2);
std::vector<std::uint8_t> hub_descriptors(bool usb2);

// String descriptor `index` (0: the languages); empty when there is none.
std::vector<std::uint8_t> string_descriptor(int index, const SensorName& name);

}  // namespace binpick::sim
