// What differs from one cell to the next and cannot be known at training: the sensor's noise, the
// light, what the part is made of, and how well it was made.
#pragma once

#include "simulation/frame_maker.hpp"
#include "simulation/sensor_kind.hpp"

namespace binpick::simulation {

FrameSetting varied_setting(const CameraParams& camera, SensorKind kind, Rng& rng);

}  // namespace binpick::simulation
