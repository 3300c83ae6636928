// The lens distortion that a camera file gives.
#pragma once

#include "replay/camera_json.hpp"

namespace binpick::drivers {

// Throws DatasetError of a model that is not OpenCV's, and names it.
LensDistortion lens_from_json(const CameraNode& camera);

}  // namespace binpick::drivers
