// Sensor profiles: TOML files that say how a kind of sensor is set up and read. Every fault,
// unknown keys included, is a SetupError that names file and line.
#pragma once

#include <string>
#include <vector>

#include "binpick/drivers/camera_spec.hpp"

namespace binpick::app {

drivers::SensorProfile load_sensor_profile(const std::string& path);

// All profiles (*.toml) of a folder, by name. Empty where there is no such folder.
std::vector<drivers::SensorProfile> load_sensor_profiles(const std::string& folder);

// The first whose vendor and model begin as the sensor's do and are not both empty; null: none.
const drivers::SensorProfile* find_profile(const std::vector<drivers::SensorProfile>& profiles,
                                           const std::string& vendor, const std::string& model);

}  // namespace binpick::app
