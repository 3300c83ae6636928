// The one place that knows which kinds of cameras there are.
#pragma once

#include <memory>
#include <string>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/camera_spec.hpp"

namespace binpick::drivers {

// A sensor, or a simulated one, that is asked for its features over network or bus.
bool is_live_sensor(const std::string& uri);

// Opens what the spec's URI names, without starting it. Throws SensorError that names the URI.
std::unique_ptr<Camera> open_camera(const CameraSpec& spec);

}  // namespace binpick::drivers
