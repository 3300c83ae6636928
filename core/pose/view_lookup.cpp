#include "pose/view_lookup.hpp"

namespace binpick {

const Viewpoint& nearest_viewpoint(const ObjectModel& model, const Pose& T_cam_centre) {
  const Eigen::Vector3f seen_along =
      (T_cam_centre.R.transpose() * T_cam_centre.t_mm.normalized()).cast<float>();
  const auto viewpoints = model.depth(model.depth_count() - 1).viewpoints;
  const Viewpoint* best = &viewpoints.front();
  float best_dot = -2;
  for (const Viewpoint& v : viewpoints) {
    // The third row of R_view_obj is the viewing direction in object axes.
    const float dot = v.R_view_obj[6] * seen_along.x() + v.R_view_obj[7] * seen_along.y() +
                      v.R_view_obj[8] * seen_along.z();
    if (dot > best_dot) {
      best_dot = dot;
      best = &v;
    }
  }
  return *best;
}

}  // namespace binpick
