#include "binpick/drivers/usb_bus.hpp"

#include <algorithm>

#include "binpick/drivers/camera.hpp"
#include "usb/usb_device.hpp"

namespace binpick::drivers {
namespace {

// Who holds the control interface uses the sensor: a reset would take it from that program.
void reset(libusb_device* device, const UsbSensor& sensor, int control_interface, bool in_use) {
  const std::string name = "USB port " + sensor.port + ": ";
  libusb_device_handle* raw = nullptr;
  int error = libusb_open(device, &raw);
  if (error != 0) throw SensorError(name + usb_open_fault(sensor.node, error));
  const UsbHandle handle(raw);
  error = in_use ? 0 : libusb_claim_interface(raw, control_interface);
  if (error == LIBUSB_ERROR_BUSY)
    throw SensorError(name + "another program is using the sensor " + sensor.serial);
  // Any other fault is what the reset is for.
  error = libusb_reset_device(raw);
  if (!in_use) libusb_release_interface(raw, control_interface);
  // Not found: it has come back as another device, as it should.
  if (error != 0 && error != LIBUSB_ERROR_NOT_FOUND)
    throw SensorError(name + "the reset failed (" + libusb_strerror(error) + ")");
}

}  // namespace

std::vector<UsbSensor> list_usb_sensors() {
  const UsbContext context = make_usb_context();
  const UsbDeviceList devices(context.get());
  std::vector<UsbSensor> sensors;
  for (libusb_device* device : devices) {
    if (auto sensor = describe_usb_sensor(device)) sensors.push_back(std::move(*sensor));
  }
  std::sort(sensors.begin(), sensors.end(),
            [](const UsbSensor& a, const UsbSensor& b) { return a.port < b.port; });
  return sensors;
}

std::string usb_access_fault(const std::string& serial) {
  try {
    for (const UsbSensor& sensor : list_usb_sensors()) {
      if (sensor.serial == serial && !sensor.access_fault.empty()) return sensor.access_fault;
    }
  } catch (const SensorError&) {
  }
  return "";
}

void reset_usb_port(const std::string& serial_or_port, bool in_use) {
  const UsbContext context = make_usb_context();
  const UsbDeviceList devices(context.get());
  for (libusb_device* device : devices) {
    const auto interface = find_u3v_interface(device);
    if (!interface) continue;
    const auto sensor = describe_usb_sensor(device);
    if (!sensor || (sensor->serial != serial_or_port && sensor->port != serial_or_port)) continue;
    return reset(device, *sensor, interface->control_number, in_use);
  }
  throw SensorError("there is no USB3 Vision sensor " + serial_or_port + " on the bus");
}

}  // namespace binpick::drivers
