// What is said to people about a sensor's place on the bus; no libusb.
#include <algorithm>
#include <bit>
#include <fstream>

#include "binpick/drivers/usb_bus.hpp"

namespace binpick::drivers {
namespace {

constexpr const char* kLimitFile = "/sys/module/usbcore/parameters/usbfs_memory_mb";
// Aravis keeps no more of a stream under way, and the driver gives it buffers for as much; what
// does not fit into the limit is lost.
constexpr int kMibPerSensor = 8;
// Commands, and the bookkeeping of the transfers.
constexpr int kMibBeside = 1;

}  // namespace

const char* usb_speed_name(UsbSpeed speed) {
  switch (speed) {
    case UsbSpeed::kLow:
      return "1.5 Mbit/s";
    case UsbSpeed::kFull:
      return "12 Mbit/s";
    case UsbSpeed::kHigh:
      return "480 Mbit/s";
    case UsbSpeed::kSuper:
      return "5 Gbit/s";
    case UsbSpeed::kSuperPlus:
      return "10 Gbit/s";
    case UsbSpeed::kUnknown:
      break;
  }
  return "unknown speed";
}

std::vector<std::string> usb_warnings(const UsbSensor& sensor) {
  std::vector<std::string> warnings;
  const std::string name = sensor.serial.empty() ? sensor.port : sensor.serial;
  const bool slow = sensor.speed != UsbSpeed::kUnknown && sensor.speed < UsbSpeed::kSuper;
  if (slow && sensor.super_speed_capable)
    warnings.push_back(name + ": a USB 3 sensor runs at " + usb_speed_name(sensor.speed) +
                       " at port " + sensor.port +
                       ": use a USB 3 port, and a cable and hubs made for it");
  if (!sensor.access_fault.empty()) warnings.push_back(name + ": " + sensor.access_fault);
  if (sensor.serial.empty())
    warnings.push_back(name + ": the sensor tells no serial number to open it by");
  return warnings;
}

long usbfs_memory_limit_mib() {
  long limit_mib = -1;
  std::ifstream file(kLimitFile);
  return file >> limit_mib ? limit_mib : -1;
}

std::string usbfs_memory_advice(long limit_mib, int sensor_count) {
  const int needed_mib = kMibPerSensor * std::max(sensor_count, 1) + kMibBeside;
  if (limit_mib <= 0 || needed_mib <= limit_mib) return "";
  // Twice as much: other programs use the bus too.
  const std::string enough = std::to_string(std::bit_ceil(static_cast<unsigned>(2 * needed_mib)));
  return "transfers of " + std::to_string(sensor_count) + " USB sensors take " +
         std::to_string(needed_mib) + " MiB, the kernel's limit is " + std::to_string(limit_mib) +
         ": echo " + enough + " > " + kLimitFile +
         ", for good by the kernel parameter usbcore.usbfs_memory_mb=" + enough +
         " or firmware-config/tmpfiles/60-binpick-usb.conf";
}

}  // namespace binpick::drivers
