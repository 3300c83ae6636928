// Perspective-n-point: the pose that projects model points onto their image points (paper section
// III-D), found iteratively from a start pose.
#pragma once

#include <span>

#include "binpick/geometry/camera_model.hpp"
#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct Correspondence {
  Vec3 point_obj;  // mm, in the coordinates that the pose maps from
  Vec2 pixel;      // where the image shows it
  Vec2 normal;     // unit: only the error along it counts (a point on an edge may slide along it);
                   // zero: both axes count
  double weight = 1;
};

struct PnpResult {
  int iterations = 0;
  double rms_px = 0;  // weighted, at the end
  bool converged = false;
};

// Levenberg-Marquardt on the reprojection error. Needs at least 3 points, or 6 edge points;
// converges from within about 25 degrees and a quarter of the distance for points spread over the
// part (tests/core/pnp_test.cpp).
PnpResult solve_pnp(std::span<const Correspondence> correspondences, const CameraIntrinsics& camera,
                    Pose& T_cam_obj);

// The correspondences of a matched template: its viewpoint's contour points and the image edges
// found beside their projections. At most `out.size()`; returns how many.
int template_correspondences(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
                             int range_px, std::span<Correspondence> out);

}  // namespace binpick
