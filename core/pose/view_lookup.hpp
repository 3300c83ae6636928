// The stored samples of the leaf viewpoint from which a part is seen.
#pragma once

#include "binpick/model/object_model.hpp"

namespace binpick {

// The direction in which the camera looks at the part, in object axes.
inline Vec3 seen_along(const Pose& T_cam_centre) {
  return T_cam_centre.R.transpose() * T_cam_centre.t_mm.normalized();
}

// The leaf viewpoint nearest to the direction from which the camera sees the part at this pose.
const Viewpoint& nearest_viewpoint(const ObjectModel& model, const Pose& T_cam_centre);

// The same for a pose that is moved in small steps: viewpoints are only gone through again when
// another one may have become the nearest.
class FollowedViewpoint {
 public:
  explicit FollowedViewpoint(const ObjectModel& model) : model_(model) {}
  const Viewpoint& at(const Pose& T_cam_centre);

 private:
  const ObjectModel& model_;
  const Viewpoint* found_ = nullptr;
  Eigen::Vector3f direction_ = Eigen::Vector3f::Zero();  // for which it was found, in object axes
  float lead_ = 0;
};

// Along which the camera looks at the part from a viewpoint, in object axes.
inline Vec3 viewing_direction(const Viewpoint& v) {
  return {static_cast<double>(v.R_view_obj[6]), static_cast<double>(v.R_view_obj[7]),
          static_cast<double>(v.R_view_obj[8])};
}

inline Vec3 position_of(const SurfaceSample& s) {
  return {static_cast<double>(s.position_mm[0]), static_cast<double>(s.position_mm[1]),
          static_cast<double>(s.position_mm[2])};
}
inline Vec3 normal_of(const SurfaceSample& s) {
  return {static_cast<double>(s.normal[0]), static_cast<double>(s.normal[1]),
          static_cast<double>(s.normal[2])};
}
inline Vec3 position_of(const ContourSample& s) {
  return {static_cast<double>(s.position_mm[0]), static_cast<double>(s.position_mm[1]),
          static_cast<double>(s.position_mm[2])};
}
inline Vec3 tangent_of(const ContourSample& s) {
  return {static_cast<double>(s.tangent[0]), static_cast<double>(s.tangent[1]),
          static_cast<double>(s.tangent[2])};
}

}  // namespace binpick
