#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

struct Nearest {
  const Viewpoint* viewpoint;
  float lead;  // of its cosine over the second one's
};

Nearest nearest_to(const Eigen::Vector3f& direction, const ObjectModel& model) {
  const auto viewpoints = model.depth(model.depth_count() - 1).viewpoints;
  const Viewpoint* best = &viewpoints.front();
  float best_dot = -2, second_dot = -2;
  for (const Viewpoint& v : viewpoints) {
    // The third row of R_view_obj is the viewing direction in object axes.
    const float dot = v.R_view_obj[6] * direction.x() + v.R_view_obj[7] * direction.y() +
                      v.R_view_obj[8] * direction.z();
    if (dot <= second_dot) continue;
    if (dot > best_dot) {
      second_dot = best_dot;
      best_dot = dot;
      best = &v;
    } else {
      second_dot = dot;
    }
  }
  return {best, best_dot - second_dot};
}

}  // namespace

const Viewpoint& nearest_viewpoint(const ObjectModel& model, const Pose& T_cam_centre) {
  return *nearest_to(seen_along(T_cam_centre).cast<float>(), model).viewpoint;
}

// A cosine changes by no more than the direction does: while that is less than half the lead, no
// other viewpoint can have become the nearest.
const Viewpoint& FollowedViewpoint::at(const Pose& T_cam_centre) {
  constexpr float kRounding = 1e-6f;
  const Eigen::Vector3f direction = seen_along(T_cam_centre).cast<float>();
  if (found_ == nullptr || (direction - direction_).norm() + kRounding > lead_ / 2) {
    const Nearest nearest = nearest_to(direction, model_);
    found_ = nearest.viewpoint;
    lead_ = nearest.lead;
    direction_ = direction;
  }
  return *found_;
}

}  // namespace binpick
