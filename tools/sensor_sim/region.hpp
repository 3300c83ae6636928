// The part of its image that a sensor sends.
// Thread-safe: functions of their arguments.
#pragma once

#include "scene_source.hpp"

namespace binpick::sim {

struct Region {
  int x = 0, y = 0, width = 0, height = 0;  // px, inside of the image
};

// What the sensor sees there. The principal point is counted from the region's corner, as the
// naming convention has it.
SceneFrame cut_out(const SceneFrame& frame, const Region& region);

}  // namespace binpick::sim
