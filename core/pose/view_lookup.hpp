// The stored samples of the leaf viewpoint from which a part is seen.
#pragma once

#include "binpick/model/object_model.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick {

// The direction in which the camera looks at the part, in object axes.
inline Vec3 seen_along(const Pose& T_cam_centre) {
  return T_cam_centre.R.transpose() * T_cam_centre.t_mm.normalized();
}

// Along which the camera looks at the part from a viewpoint, in object axes.
inline Vec3 viewing_direction(const Viewpoint& v) {
  return {static_cast<double>(v.R_view_obj[6]), static_cast<double>(v.R_view_obj[7]),
          static_cast<double>(v.R_view_obj[8])};
}

inline std::span<const Viewpoint> leaf_viewpoints(const ObjectModel& model) {
  return model.depth(model.depth_count() - 1).viewpoints;
}

// The leaf viewpoint nearest to a direction, or to the one from which the camera sees the part.
inline const Viewpoint& nearest_viewpoint(const ObjectModel& model,
                                          const simd::PoseKernels& kernels, const Vec3& seen) {
  const float direction[3] = {static_cast<float>(seen.x()), static_cast<float>(seen.y()),
                              static_cast<float>(seen.z())};
  const int index = kernels.nearest_direction(model.viewing_directions(), direction);
  return leaf_viewpoints(model)[static_cast<std::size_t>(index)];
}
inline const Viewpoint& nearest_viewpoint(const ObjectModel& model,
                                          const simd::PoseKernels& kernels,
                                          const Pose& T_cam_centre) {
  return nearest_viewpoint(model, kernels, seen_along(T_cam_centre));
}

// For the kernels.
inline simd::PoseF pose_f(const Pose& T) {
  simd::PoseF out;
  for (int i = 0; i < 9; ++i) out.R[i] = static_cast<float>(T.R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) out.t[i] = static_cast<float>(T.t_mm[i]);
  return out;
}

}  // namespace binpick
