#include "pose/verify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pose/contour.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// Normals of model and measurement that differ by more than this do not support each other.
constexpr double kNormalCosMin = 0.75;
constexpr int kContourRangePx = 3;
// What must be measured of a part before its score counts fully.
constexpr double kMeasuredEnough = 0.35;

struct Tolerances {
  double fit_mm, conflict_mm;
};

Tolerances tolerances(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const double noise = scene.depth_error_mm(T.t_mm.z());
  const double fit = std::max(2 * noise, 0.008 * model.info().diameter_mm);
  return {fit, 3 * fit + 2 * noise};
}

void add_surface(const ObjectModel& model, const Scene& scene, const Pose& T, const Viewpoint& view,
                 Evidence& e) {
  const Tolerances tolerance = tolerances(model, scene, T);
  float residuals[512];
  int residual_count = 0;
  for (const SurfaceSample& s : model.surface(view)) {
    const Vec3 p = T * position_of(s);
    const Vec3 n = T.R * normal_of(s);
    ++e.samples;
    const auto [u, v, z] = scene.measured_at(p);
    if (!(z > 0)) {
      ++e.unknown;
      continue;
    }
    const double r = n.dot(scene.depth.camera.unproject(u, v, z) - p);
    if (z < p.z() && r > tolerance.conflict_mm) {
      ++e.hidden;
    } else if (z > p.z() && r < -tolerance.conflict_mm) {
      ++e.contradicted;
    } else {
      ++e.measured;
      const double fit = std::exp(-0.5 * r * r / (tolerance.fit_mm * tolerance.fit_mm));
      const double agreement = normal_agreement(scene, u, v, p, n);
      e.supported += fit * std::clamp((agreement - kNormalCosMin + 0.15) / 0.15, 0.2, 1.0);
      if (residual_count < 512) residuals[residual_count++] = static_cast<float>(std::fabs(r));
    }
  }
  if (residual_count > 0) {
    std::nth_element(residuals, residuals + residual_count / 2, residuals + residual_count);
    e.residual_mm = static_cast<double>(residuals[residual_count / 2]);
  }
}

// Whether a depth step of the contour's direction lies at its place or beside it.
bool on_depth_edge(const Scene& scene, const Vec3& point_cam, const Vec2& normal) {
  const PyramidLevel& level = scene.depth;
  const auto [u, v, depth_mm] = scene.measured_at(point_cam);
  if (u < 1 || v < 1 || u >= level.width - 1 || v >= level.height - 1) return false;
  const std::ptrdiff_t stride = level.stride;
  const std::uint8_t* at = level.depth_edges + v * stride + u;
  const unsigned steps = static_cast<unsigned>(at[0] | at[-1] | at[1] | at[-stride] | at[stride]);
  const double turn = std::atan2(normal.y(), normal.x()) * 8 / std::numbers::pi + 16.5;
  const int bin = static_cast<int>(turn) & 7;
  const unsigned near = (1u << bin) | (1u << ((bin + 1) & 7)) | (1u << ((bin + 7) & 7));
  return (steps & near) != 0;
}

void add_contours(const ObjectModel& model, const Scene& scene, const Pose& T,
                  const Viewpoint& view, Evidence& e) {
  const double tolerance_mm = 2 * tolerances(model, scene, T).conflict_mm;
  for (const ContourSample& s : model.contour(view)) {
    if (s.is_silhouette < 0.5f) continue;
    const ContourPlace place = place_contour(s, scene, T, kContourRangePx, tolerance_mm);
    if (!place.visible) continue;
    ++e.contours;
    if (on_depth_edge(scene, place.point_cam, place.normal_px)) {
      e.contours_supported += 1;
      continue;
    }
    const ContourMatch m = match_contour(place, scene, kContourRangePx);
    if (m.found)
      e.contours_supported += 0.6 + 0.4 * (1 - std::abs(m.offset_px) / (kContourRangePx + 1));
  }
}

}  // namespace

double normal_agreement(const Scene& scene, int u, int v, const Vec3& p, const Vec3& n_cam) {
  const std::ptrdiff_t i = v * scene.depth.stride + u;
  if (!scene.depth.normal_valid[i]) return 1;
  const double x = static_cast<double>(scene.depth.normal_x[i]),
               y = static_cast<double>(scene.depth.normal_y[i]);
  const Vec3 n_ray(x, y, -std::sqrt(std::max(0.0, 1 - x * x - y * y)));
  return n_cam.dot(rotation_between(Vec3::UnitZ(), p.normalized()) * n_ray);
}

double Evidence::score() const {
  const double seen = std::min(1.0, measured_fraction() / kMeasuredEnough);
  return depth_support() * contour_support() * contour_support() * seen;
}

double Evidence::explained_mm2() const {
  const double fit = score();
  return supported * sample_area_mm2 * fit * fit * fit;
}

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T) {
  Evidence e;
  const Viewpoint& view = nearest_viewpoint(model, T);
  e.sample_area_mm2 = static_cast<double>(view.sample_area_mm2);
  add_surface(model, scene, T, view, e);
  add_contours(model, scene, T, view, e);
  return e;
}

}  // namespace binpick
