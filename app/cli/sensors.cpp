// binpick sensors: which sensors are on the network and on the bus.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "binpick/drivers/sensor_list.hpp"
#include "cli/commands.hpp"
#include "cli/sensor_arguments.hpp"
#include "sensor/sensor_profile_file.hpp"

namespace binpick::app {
namespace {

void print_sensors() {
  const auto sensors = drivers::list_sensors();
  if (sensors.empty()) {
    std::printf("no sensors found\n");
    return;
  }
  const auto profiles = load_sensor_profiles(sensor_profile_folder());
  std::printf("%-28s %-24s %-24s %-16s %s\n", "uri", "vendor", "model", "address", "profile");
  for (const drivers::SensorEntry& s : sensors) {
    const auto* profile = find_profile(profiles, s.vendor, s.model);
    std::printf("%-28s %-24s %-24s %-16s %s\n", s.uri.c_str(), s.vendor.c_str(), s.model.c_str(),
                s.address.empty() ? "-" : s.address.c_str(),
                profile != nullptr ? profile->name.c_str() : "- (generic-genicam-3d)");
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
