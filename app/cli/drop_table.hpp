// What a sensor's counters say, for people.
#pragma once

#include "binpick/drivers/camera.hpp"

namespace binpick::app {

// One line of what came and what was lost, and why; to stdout.
void print_drops(const drivers::CameraCounters& counters);

}  // namespace binpick::app
