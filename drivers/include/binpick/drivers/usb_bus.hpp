// The USB bus beneath the USB3 Vision sensors: who sits where and how fast, what stands in their
// way, and the reset of a port. Allocates and asks the system: for set-up, recovery and people.
// Takes nothing away from a program that is using a sensor. Thread-safe.
#pragma once

#include <string>
#include <vector>

namespace binpick::drivers {

// Of the connection, not of the device; in the order of speed.
enum class UsbSpeed { kUnknown, kLow, kFull, kHigh, kSuper, kSuperPlus };
const char* usb_speed_name(UsbSpeed speed);  // "5 Gbit/s"

struct UsbSensor {
  std::string vendor, model, serial;  // empty: nobody may or can say
  UsbSpeed speed = UsbSpeed::kUnknown;
  bool super_speed_capable = false;  // made for USB 3
  std::string port;                  // bus and ports as the kernel names them: "2-3.1"
  std::string node;                  // "/dev/bus/usb/002/004"; another one after each arrival
  std::string access_fault;          // why it cannot be opened and what to do; empty: it can

  std::string uri() const { return "u3v://serial/" + serial; }
};

// USB3 Vision devices, in the order of their ports. Throws SensorError where there is no USB at
// all.
std::vector<UsbSensor> list_usb_sensors();

// Sentences about what keeps this sensor from working well; none: nothing does.
std::vector<std::string> usb_warnings(const UsbSensor& sensor);

// Why the sensor with this serial number cannot be opened; empty: it can, or is not on the bus, or
// the bus cannot be asked.
std::string usb_access_fault(const std::string& serial);

// Resets the port of the sensor with this serial number, or at this port ("2-3.1"): as if it were
// pulled out and put in again. Throws SensorError when no such sensor is on the bus, it may not be
// opened, or a program is using it. `in_use`: the caller's own connection to it is still open, so
// that no other program can be using it; what that has under way then fails at once.
void reset_usb_port(const std::string& serial_or_port, bool in_use = false);

// How much memory the kernel lends for USB transfers of all programs together, MiB; 0: as much as
// there is; -1: not known.
long usbfs_memory_limit_mib();

// What to set when the transfers of so many sensors do not fit below the limit; empty: they do, or
// nobody knows. A sensor's frames take the same whatever their size: see drivers/aravis.
std::string usbfs_memory_advice(long limit_mib, int sensor_count);

}  // namespace binpick::drivers
