#include "pose/icp.hpp"

#include <algorithm>
#include <cmath>

#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kAlignSamplesMax = 96;

}  // namespace

bool align_depth(const ObjectModel& model, const Scene& scene, double range_mm, Pose& T) {
  const auto surface = model.surface(nearest_viewpoint(model, T));
  const int step = std::max<int>(1, static_cast<int>(surface.size()) / kAlignSamplesMax + 1);
  float difference[kAlignSamplesMax];
  int count = 0;
  for (std::size_t i = 0; i < surface.size() && count < kAlignSamplesMax;
       i += static_cast<std::size_t>(step)) {
    const Vec3 p = T * position_of(surface[i]);
    const float z = static_cast<float>(scene.measured_at(p).depth_mm);
    const float d = z - static_cast<float>(p.z());
    if (z > 0 && std::fabs(d) <= static_cast<float>(range_mm)) difference[count++] = d;
  }
  if (count < 8) return false;
  std::sort(difference, difference + count);
  const float window = static_cast<float>(0.08 * model.info().diameter_mm);
  int best_first = 0, best_size = 0;
  for (int first = 0, last = 0; first < count; ++first) {
    while (last < count && difference[last] <= difference[first] + window) ++last;
    if (last - first > best_size) {
      best_size = last - first;
      best_first = first;
    }
  }
  if (best_size < 8) return false;
  const double shift = static_cast<double>(difference[best_first + best_size / 2]);
  T.t_mm *= 1 + shift / T.t_mm.z();
  return true;
}

int add_depth_residuals(const Viewpoint& view, const ObjectModel& model, const Scene& scene,
                        const Pose& T, int sample_step, double gate_mm, double sigma_mm,
                        NormalEquations& equations) {
  const auto surface = model.surface(view);
  const CameraIntrinsics& camera = scene.depth.camera;
  int pairs = 0;
  for (std::size_t i = 0; i < surface.size(); i += static_cast<std::size_t>(sample_step)) {
    const Vec3 p = T * position_of(surface[i]);
    const Vec3 n = T.R * normal_of(surface[i]);
    if (n.dot(p) >= 0) continue;  // turned away meanwhile
    const auto [u, v, z] = scene.measured_at(p);
    if (!(z > 0)) continue;
    const double r = n.dot(p - camera.unproject(u, v, z));
    if (std::abs(r) > gate_mm || std::abs(z - p.z()) > 3 * gate_mm) continue;
    equations.add(point_gradient(n, p, T.t_mm) / sigma_mm, r / sigma_mm, robust_weight(r, gate_mm));
    ++pairs;
  }
  return pairs;
}

IcpResult icp(const ObjectModel& model, const Scene& scene, const IcpParams& params, Pose& T) {
  IcpResult result;
  const double shrink =
      params.iterations_max > 1
          ? std::pow(params.gate_end_mm / params.gate_start_mm, 1.0 / (params.iterations_max - 1))
          : 1.0;
  FollowedViewpoint viewpoint(model);
  double gate_mm = params.gate_start_mm;
  for (int i = 0; i < params.iterations_max; ++i, gate_mm *= shrink) {
    NormalEquations equations;
    result.pairs = add_depth_residuals(viewpoint.at(T), model, scene, T, params.sample_step,
                                       gate_mm, 1.0, equations);
    if (result.pairs < 10) return result;
    result.rms_mm = std::sqrt(equations.cost / equations.count);
    // Directions along which the surface slides are held by a prior worth a few samples.
    const double radius = model.info().diameter_mm / 4;
    const auto step = equations.solve(0.02 * result.pairs * radius * radius, 0.02 * result.pairs);
    const Vec3 turn = step.head<3>(), shift = step.tail<3>();
    T = left_increment(T, turn, shift, T.t_mm);
    if (turn.norm() * radius < 0.005 && shift.norm() < 0.005 &&
        gate_mm <= params.gate_end_mm * 1.05)
      break;
  }
  T.R = orthonormalized(T.R);
  return result;
}

}  // namespace binpick
