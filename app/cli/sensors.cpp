// binpick sensors: which sensors are on the network and on the bus.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/sensor_list.hpp"
#include "binpick/drivers/usb_bus.hpp"
#include "cli/commands.hpp"
#include "cli/sensor_arguments.hpp"
#include "sensor/sensor_profile_file.hpp"

namespace binpick::app {
namespace {

std::vector<drivers::UsbSensor> usb_sensors() {
  try {
    return drivers::list_usb_sensors();
  } catch (const drivers::SensorError& e) {
    std::fprintf(stderr, "binpick: warning: %s\n", e.what());
    return {};
  }
}

// Fills in where the sensors sit on the bus, and adds those that may not be opened.
void add_usb_places(std::vector<drivers::SensorEntry>& sensors,
                    const std::vector<drivers::UsbSensor>& bus) {
  for (const drivers::UsbSensor& usb : bus) {
    auto entry = std::find_if(sensors.begin(), sensors.end(), [&](const auto& s) {
      return s.protocol == "USB3Vision" && s.serial == usb.serial;
    });
    if (entry == sensors.end())
      entry =
          sensors.insert(entry, {"USB3Vision", usb.vendor, usb.model, usb.serial, "", usb.uri()});
    entry->address = "USB " + usb.port + ", " + drivers::usb_speed_name(usb.speed);
  }
}

void print_sensors() {
  auto sensors = drivers::list_sensors();
  const auto bus = usb_sensors();
  add_usb_places(sensors, bus);
  if (sensors.empty()) {
    std::printf("no sensors found\n");
    return;
  }
  const auto profiles = load_sensor_profiles(sensor_profile_folder());
  std::printf("%-28s %-24s %-24s %-24s %s\n", "uri", "vendor", "model", "address", "profile");
  for (const drivers::SensorEntry& s : sensors) {
    const auto* profile = find_profile(profiles, s.vendor, s.model);
    std::printf("%-28s %-24s %-24s %-24s %s\n", s.uri.c_str(), s.vendor.c_str(), s.model.c_str(),
                s.address.empty() ? "-" : s.address.c_str(),
                profile != nullptr ? profile->name.c_str() : "- (generic-genicam-3d)");
  }
  for (const drivers::UsbSensor& usb : bus) {
    for (const std::string& warning : drivers::usb_warnings(usb))
      std::printf("warning: %s\n", warning.c_str());
  }
}

}  // namespace

void add_sensors_command(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("sensors", "List the sensors on the network and on the USB bus");
  command->callback([&exit_status] {
    print_sensors();
    exit_status = 0;
  });
}

}  // namespace binpick::app
