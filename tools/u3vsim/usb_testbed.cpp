#include "usb_testbed.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "usb_descriptors.hpp"

namespace binpick::sim {
namespace {

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02X", byte);
    text += digits;
  }
  return text;
}

// USB 3 and USB 2 ports are on buses of their own, also when they share a socket.
int bus_number(bool usb2) {
  return usb2 ? 1 : 2;
}

std::string hub_path(bool usb2) {
  return "/devices/pci0000:00/0000:00:14.0/usb" + std::to_string(bus_number(usb2));
}

std::string camera_path(bool usb2) {
  return hub_path(usb2) + "/" + std::to_string(bus_number(usb2)) + "-3";
}

std::string node_path(bool usb2, int device_number) {
  char text[40];
  std::snprintf(text, sizeof text, "bus/usb/%03d/%03d", bus_number(usb2), device_number);
  return text;
}

std::string device_text(const std::string& path, bool usb2, int device_number,
                        const std::vector<std::uint8_t>& descriptors,
                        const std::string& more_attributes) {
  const std::string node = node_path(usb2, device_number);
  const std::string bus = std::to_string(bus_number(usb2));
  const std::string number = std::to_string(device_number);
  const int minor = 128 * (bus_number(usb2) - 1) + device_number - 1;
  return "P: " + path + "\nN: " + node + "\nE: DEVNAME=/dev/" + node +
         "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=" + bus + "\nE: DEVNUM=" + number +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(minor) +
         "\nA: dev=189:" + std::to_string(minor) + "\\n\nA: busnum=" + bus +
         "\\n\nA: devnum=" + number + "\\n\nA: speed=" + (usb2 ? "480" : "5000") +
         "\\n\nA: bConfigurationValue=1\\n\n" + more_attributes +
         "H: descriptors=" + hex(descriptors) + "\n\n";
}

// What the kernel keeps of a device's strings.
std::string name_attributes(const SensorName& name) {
  return "A: manufacturer=" + name.vendor + "\\n\nA: product=" + name.model +
         "\\n\nA: serial=" + name.serial + "\\n\n";
}

void write_memory_limit(const std::string& testbed, int limit_mib) {
  const std::string folder = testbed + "/sys/module/usbcore/parameters";
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/usbfs_memory_mb") << limit_mib << "\n";
}

}  // namespace

UsbTestbed::UsbTestbed(UsbfsEmulation& camera, const UsbBusOptions& options)
    : camera_(camera), name_(options.name), usb2_(options.usb2), bed_(umockdev_testbed_new()) {
  gchar* folder = umockdev_testbed_get_root_dir(bed_);
  folder_ = folder;
  g_free(folder);
  add_device(device_text(hub_path(usb2_), usb2_, device_number_, hub_descriptors(usb2_), ""));
  write_memory_limit(folder_, options.usbfs_memory_mib);
  plug();
}

UsbTestbed::~UsbTestbed() {
  if (plugged_) umockdev_testbed_detach_ioctl(bed_, device_node().c_str(), nullptr);
  g_object_unref(bed_);
}

std::string UsbTestbed::device_node() const {
  return "/dev/" + node_path(usb2_, device_number_);
}

void UsbTestbed::add_device(const std::string& text) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(bed_, text.c_str(), &error)) return;
  const std::string reason = error == nullptr ? "no reason given" : error->message;
  g_clear_error(&error);
  throw std::runtime_error("umockdev: " + reason);
}

void UsbTestbed::plug() {
  if (plugged_) return;
  ++device_number_;
  camera_.set_plugged(true);
  // Before the device shows up: who sees it may open it at once.
  GError* error = nullptr;
  if (!umockdev_testbed_attach_ioctl(bed_, device_node().c_str(), camera_.handler(), &error)) {
    const std::string reason = error == nullptr ? "no reason given" : error->message;
    g_clear_error(&error);
    throw std::runtime_error("umockdev: " + reason);
  }
  add_device(device_text(camera_path(usb2_), usb2_, device_number_, camera_descriptors(usb2_),
                         name_attributes(name_)));
  plugged_ = true;  // umockdev has sent the event
}

void UsbTestbed::unplug() {
  if (!plugged_) return;
  camera_.set_plugged(false);
  const std::string path = "/sys" + camera_path(usb2_);
  umockdev_testbed_uevent(bed_, path.c_str(), "remove");
  umockdev_testbed_remove_device(bed_, path.c_str());
  umockdev_testbed_detach_ioctl(bed_, device_node().c_str(), nullptr);
  plugged_ = false;
}

}  // namespace binpick::sim
