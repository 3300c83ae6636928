// Transforms of a configuration: what is no rotation is a fault; what is merely unlikely for a
// robot cell is a warning. Set-up only.
#pragma once

#include "config/config_keys.hpp"
#include "config/config_reader.hpp"

namespace binpick::app {

// Faults of one transform: written in two ways, or not as a rotation.
void check_pose(const PoseKeys& keys, const WrittenPose& pose, ConfigReader& reader);

// Of a configuration without faults: metres where mm are meant, radians where degrees are, and no
// transform where one is needed.
std::vector<ConfigFault> pose_warnings(const Config& config);

}  // namespace binpick::app
