#include "pose/pnp.hpp"

#include <cmath>

#include "pose/contour.hpp"
#include "pose/normal_equations.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kIterationsMax = 30;
constexpr double kDecreaseMin = 1e-5;  // of the cost, in a step

// Residuals and derivatives at a pose; a point behind the camera makes the cost infinite.
NormalEquations reprojection(std::span<const Correspondence> correspondences,
                             const CameraIntrinsics& camera, const Pose& T) {
  NormalEquations equations;
  for (const Correspondence& c : correspondences) {
    const Vec3 p = T * c.point_obj;
    if (!(p.z() > 1e-3)) {
      equations.cost = HUGE_VAL;
      return equations;
    }
    const Vec2 error = camera.project(p) - c.pixel;
    const Vec3 du(camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()));
    const Vec3 dv(0, camera.fy / p.z(), -camera.fy * p.y() / (p.z() * p.z()));
    if (c.normal.isZero()) {
      equations.add(point_gradient(du, p, T.t_mm), error.x(), c.weight);
      equations.add(point_gradient(dv, p, T.t_mm), error.y(), c.weight);
    } else {
      const Vec3 d = c.normal.x() * du + c.normal.y() * dv;
      equations.add(point_gradient(d, p, T.t_mm), c.normal.dot(error), c.weight);
    }
  }
  return equations;
}

}  // namespace

PnpResult solve_pnp(std::span<const Correspondence> correspondences, const CameraIntrinsics& camera,
                    Pose& T) {
  PnpResult result;
  NormalEquations now = reprojection(correspondences, camera, T);
  if (now.count < 6 || !std::isfinite(now.cost)) return result;
  double damping = 1e-3;
  while (result.iterations < kIterationsMax && !result.converged) {
    ++result.iterations;
    NormalEquations damped = now;
    damped.H.diagonal() *= 1 + damping;
    const auto step = damped.solve(1e-9, 1e-9);
    const Pose moved = left_increment(T, step.head<3>(), step.tail<3>(), T.t_mm);
    const NormalEquations then = reprojection(correspondences, camera, moved);
    if (std::isfinite(then.cost) && then.cost <= now.cost) {
      result.converged =
          now.cost - then.cost <= kDecreaseMin * now.cost + 1e-18 || step.norm() < 1e-7;
      T = moved;
      now = then;
      damping *= 0.3;
    } else {
      damping *= 8;
      if (damping > 1e8) result.converged = true;
    }
  }
  T.R = orthonormalized(T.R);
  result.rms_px = std::sqrt(now.cost / now.count);
  return result;
}

int template_correspondences(const ObjectModel& model, const Scene& scene, const Pose& T,
                             int range_px, std::span<Correspondence> out) {
  const double depth_tolerance_mm = 0.05 * model.info().diameter_mm + 0.005 * T.t_mm.z();
  std::size_t count = 0;
  for (const ContourSample& sample : model.contour(nearest_viewpoint(model, T))) {
    if (count == out.size()) break;
    const ContourPlace place = place_contour(sample, scene, T, range_px, depth_tolerance_mm);
    if (!place.visible) continue;
    const ContourMatch m = match_contour(place, scene, range_px);
    if (!m.found) continue;
    const double k = m.offset_px / range_px;
    out[count++] = {position_of(sample), place.pixel + m.offset_px * place.normal_px,
                    place.normal_px, 1 / (1 + 4 * k * k)};
  }
  return static_cast<int>(count);
}

}  // namespace binpick
