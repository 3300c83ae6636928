// The contour of a part as its trained model remembers it: for pictures where no CAD file is at
// hand.
#pragma once

#include <vector>

#include "binpick/model/object_model.hpp"

namespace binpick::app {

// The contour samples of the trained viewpoint nearest to how the camera sees the part, in pixels.
// Points behind the camera are left out.
std::vector<Vec2> contour_points_px(const ObjectModel& model, const CameraIntrinsics& camera,
                                    const Pose& T_cam_obj);

}  // namespace binpick::app
