// The covariance of an aligned pose, from the residuals that the alignment minimizes.
#pragma once

#include "binpick/report/pose_uncertainty.hpp"
#include "pose/scene.hpp"

namespace binpick {

// Inverse of the information of depth and contours at the pose, in units of the residuals' own
// scatter, times the model's variance_scale: neighbouring measurements err alike, by how much
// training tells. A direction that nothing holds ends at a prior of a quarter of the diameter.
PoseUncertainty pose_uncertainty(const ObjectModel& model, const Scene& scene,
                                 const Pose& T_cam_centre);

}  // namespace binpick
