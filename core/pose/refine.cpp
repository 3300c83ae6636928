#include "pose/refine.hpp"

#include <algorithm>
#include <cmath>

#include "pose/contour_pose.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {

RefineParams refine_params(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const double z_mm = T.t_mm.z();
  RefineParams params;
  params.depth_gate_mm =
      std::max({0.02 * model.info().diameter_mm, 0.002 * z_mm, 3 * scene.depth_noise_mm(z_mm)});
  return params;
}

int add_residuals(const ObjectModel& model, const Viewpoint& view, const Scene& scene,
                  const RefineParams& params, int contour_range_px, const Pose& T,
                  NormalEquations& equations) {
  if (!scene.with_depth)
    return add_directed_residuals(model, scene, T, contour_range_px, equations);
  const double depth_sigma_mm = scene.depth_noise_mm(T.t_mm.z());
  const double depth_tolerance_mm = 0.02 * model.info().diameter_mm + 0.003 * T.t_mm.z();
  const int pairs = add_depth_residuals(view, model, scene, T, 1, params.depth_gate_mm,
                                        depth_sigma_mm, equations);
  return pairs + add_contour_residuals(view, model, scene, T, contour_range_px,
                                       params.contour_sigma_px, depth_tolerance_mm, equations);
}

void refine(const ObjectModel& model, const Scene& scene, const RefineParams& params, Pose& T) {
  if (!scene.with_depth) return refine_on_contour(model, scene, T);
  const double radius = model.info().diameter_mm / 4;
  const int last = params.iterations_max - 1;
  FollowedViewpoint viewpoint(model);
  for (int i = 0; i <= last; ++i) {
    const int range_px =
        params.contour_range_start_px -
        (params.contour_range_start_px - params.contour_range_end_px) * i / std::max(1, last);
    NormalEquations equations;
    if (add_residuals(model, viewpoint.at(T), scene, params, range_px, T, equations) < 12) return;
    const auto step = equations.solve(2 * radius * radius, 2);
    const Vec3 turn = step.head<3>(), shift = step.tail<3>();
    T = left_increment(T, turn, shift, T.t_mm);
    if (turn.norm() * radius < 0.002 && shift.norm() < 0.002 && i > 2) break;
  }
  T.R = orthonormalized(T.R);
}

}  // namespace binpick
