// Brings an opened sensor into the state that its spec asks for: profile, trigger, exposure,
// packets.
#pragma once

#include "aravis/features.hpp"

namespace binpick::drivers {

struct SensorSetup {
  int depth_width = 0, depth_height = 0;    // px, as the sensor is set
  int sensor_width = 0, sensor_height = 0;  // of the largest image
  std::size_t payload_bytes = 0;            // of a frame, as the sensor says
  std::size_t depth_bytes = 0;              // of its depth image; 0: not known
  bool with_points = false;                 // the depth format has x and y
};

// Throws SensorError that names the feature. Leaves the component with the depth selected. Settings
// are applied again after each reconnection: a sensor that lost power has forgotten them.
SensorSetup set_up_sensor(const Features& features, const CameraSpec& spec);

}  // namespace binpick::drivers
