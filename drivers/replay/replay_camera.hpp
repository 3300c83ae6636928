// Recorded frames as a camera: a folder in the BOP layout, all scenes in order, once or for ever,
// by the recording's times or as fast as asked for. A reader thread decodes a few frames ahead and
// copies the next one into the pool; it alone allocates.
#pragma once

#include <memory>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/camera_spec.hpp"

namespace binpick::drivers {

// `spec.uri` is replay:DIR. Throws SensorError or DatasetError.
std::unique_ptr<Camera> open_replay_camera(const CameraSpec& spec);

}  // namespace binpick::drivers
