#include "pose/verify.hpp"

#include <algorithm>
#include <cmath>

#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// Normals of model and measurement that differ by more than this do not support each other.
constexpr double kNormalCosMin = 0.75;
constexpr int kContourRangePx = 3;
// From an outline to what is looked at on either side of it, beyond what a sensor smears.
constexpr double kBesidePx = 4;

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
  const double view_area = static_cast<double>(view.sample_area_mm2);
  float residuals[512];
  int residual_count = 0;
  const Vec3 sampled_from = -viewing_direction(view);
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
      const double support = fit * std::clamp((agreement - kNormalCosMin + 0.15) / 0.15, 0.2, 1.0);
      e.supported += support;
      // A sample stands for the same area of the surface from wherever it is seen; the stored one
      // is as projected from its viewpoint, which is off by up to half the viewpoints' spacing.
      const double facing = -n.dot(p) / p.norm(), facing_then = normal_of(s).dot(sampled_from);
      e.explained_mm2 +=
          support * view_area * std::clamp(facing / std::max(facing_then, 0.05), 0.0, 2.0);
      if (residual_count < 512) residuals[residual_count++] = static_cast<float>(std::fabs(r));
    }
  }
  if (residual_count > 0) {
    std::nth_element(residuals, residuals + residual_count / 2, residuals + residual_count);
    e.residual_mm = static_cast<double>(residuals[residual_count / 2]);
  }
}

void add_crease(const ContourPlace& place, const Scene& scene, Evidence& e) {
  ++e.creases;
  const ContourMatch m = match_contour(place, scene, kContourRangePx);
  if (m.found) e.creases_supported += 1 - std::abs(m.offset_px) / (kContourRangePx + 1);
}

// Whether no depth step could show at the contour.
bool depth_missing_beside(const Scene& scene, const ContourPlace& place) {
  for (const double offset_px : {0.0, kBesidePx, -kBesidePx}) {
    if (!(scene.measured_px(place.pixel + offset_px * place.normal_px) > 0)) return true;
  }
  return false;
}

void add_outline(const ContourPlace& place, const Scene& scene, double tolerance_mm, Evidence& e) {
  ++e.contours;
  e.outline_continued += surface_continues(scene, place, tolerance_mm);
  if (on_depth_edge(scene, place.point_cam, place.normal_px)) {
    ++e.outline_steps;
    e.contours_supported += 1;
    return;
  }
  e.outline_unseen += depth_missing_beside(scene, place);
  const ContourMatch m = match_contour(place, scene, kContourRangePx);
  if (!m.found) return;
  ++e.outline_matches;
  e.outline_offset_px += std::abs(m.offset_px);
  e.contours_supported += 0.6 + 0.4 * (1 - std::abs(m.offset_px) / (kContourRangePx + 1));
}

void add_contours(const ObjectModel& model, const Scene& scene, const Pose& T,
                  const Viewpoint& view, Evidence& e) {
  const double tolerance_mm = contour_tolerance_mm(model, scene, T);
  for (const ContourSample& s : model.contour(view)) {
    const ContourPlace place = place_contour(s, scene, T, kContourRangePx, tolerance_mm);
    if (!place.visible) continue;
    if (s.is_silhouette < 0.5f) {
      if (scene.with_intensity) add_crease(place, scene, e);
    } else {
      add_outline(place, scene, tolerance_mm, e);
    }
  }
}

}  // namespace

double contour_tolerance_mm(const ObjectModel& model, const Scene& scene, const Pose& T) {
  return 2 * tolerances(model, scene, T).conflict_mm;
}

bool on_depth_edge(const Scene& scene, const Vec3& point_cam, const Vec2& normal) {
  const PyramidLevel& level = scene.depth;
  const auto [u, v, depth_mm] = scene.measured_at(point_cam);
  if (u < 1 || v < 1 || u >= level.width - 1 || v >= level.height - 1) return false;
  const std::ptrdiff_t stride = level.stride;
  const std::uint8_t* at = level.depth_edges + v * stride + u;
  const unsigned steps = static_cast<unsigned>(at[0] | at[-1] | at[1] | at[-stride] | at[stride]);
  return (steps & edge_directions_near(normal)) != 0;
}

bool surface_continues(const Scene& scene, const ContourPlace& place, double tolerance_mm) {
  const auto beside = [&](double offset_px) {
    const Vec2 px = place.pixel + offset_px * place.normal_px;
    return scene.measured_px(px);
  };
  const double a = beside(kBesidePx), b = beside(-kBesidePx);
  return a > 0 && b > 0 && std::abs(a - b) < 0.5 * tolerance_mm &&
         std::abs(a - place.point_cam.z()) < tolerance_mm;
}

double normal_agreement(const Scene& scene, int u, int v, const Vec3& p, const Vec3& n_cam) {
  const std::ptrdiff_t i = v * scene.depth.stride + u;
  if (!scene.depth.normal_valid[i]) return 1;
  const double x = static_cast<double>(scene.depth.normal_x[i]),
               y = static_cast<double>(scene.depth.normal_y[i]);
  const Vec3 n_ray(x, y, -std::sqrt(std::max(0.0, 1 - x * x - y * y)));
  // Turned as the z axis is into the ray (Rodrigues), which is less than half a turn.
  const Vec3 ray = p.normalized();
  const Vec3 axis(-ray.y(), ray.x(), 0);
  const Vec3 across = axis.cross(n_ray);
  return n_cam.dot(n_ray + across + axis.cross(across) / (1 + ray.z()));
}

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T) {
  Evidence e;
  const Viewpoint& view = nearest_viewpoint(model, T);
  e.seen = scene.modality();
  e.px2_per_mm2 = scene.px2_per_mm2(T.t_mm.z());
  add_surface(model, scene, T, view, e);
  add_contours(model, scene, T, view, e);
  return e;
}

}  // namespace binpick
