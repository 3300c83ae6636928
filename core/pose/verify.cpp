#include "pose/verify.hpp"

#include <algorithm>
#include <cmath>

#include "pose/contour.hpp"
#include "pose/tolerances.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// Normals agree fully up to 41 degrees, which is noise and the sensor's window at edges; a wrong
// one counts little, not nothing.
constexpr float kCosDisagrees = 0.6f, kCosAgrees = 0.75f, kNormalsMin = 0.2f;
constexpr int kRangePx = 3;

// 1 on the edge, towards 0 at the end of the range.
double nearness(float offset_px) {
  return 1 - static_cast<double>(std::fabs(offset_px)) / (kRangePx + 1);
}

void add_surface(const ObjectModel& model, const Scene& scene, const Pose& T, const Viewpoint& view,
                 Evidence& e) {
  const Tolerances tolerances(model, scene, T);
  const simd::SurfaceAgreement found = surface_agreement(
      scene, view, model.surface(view), T,
      {static_cast<float>(tolerances.on_surface_mm), static_cast<float>(tolerances.conflict_mm),
       kCosDisagrees, kCosAgrees, kNormalsMin});
  e.hidden = found.hidden;
  e.contradicted = found.contradicted;
  e.measured = found.agreeing;
  e.supported = static_cast<double>(found.supported);
  // A sample stands for the same area of the surface from wherever it is seen; the stored one is as
  // projected from its viewpoint, which is off by up to half the viewpoints' spacing.
  e.explained_mm2 =
      static_cast<double>(found.explained) * static_cast<double>(view.sample_area_mm2);
}

// Whether a depth step of the contour's direction lies at its place or beside it.
bool on_depth_step(const Scene& scene, const simd::ContourPlaces& places, int i) {
  const PyramidLevel& level = scene.depth;
  const auto at_level = [](float px) {
    return nearest_pixel(Scene::depth_level_px(static_cast<double>(px)));
  };
  const int u = at_level(places.u[i]), v = at_level(places.v[i]);
  if (u < 1 || v < 1 || u >= level.width - 1 || v >= level.height - 1) return false;
  const std::ptrdiff_t stride = level.stride;
  const std::uint8_t* at = level.depth_edges + v * stride + u;
  const unsigned steps = static_cast<unsigned>(at[0] | at[-1] | at[1] | at[-stride] | at[stride]);
  return (steps & edge_directions_near(places.normal_u[i], places.normal_v[i])) != 0;
}

// The outline on depth steps; what lies there needs no edge, and its place is struck out.
void add_outline_steps(const Scene& scene, ContourMatches& m, Evidence& e) {
  for (int i = 0; i < m.outline_count; ++i) {
    if (!m.places.visible[i]) continue;
    ++e.contours;
    if (on_depth_step(scene, m.places, i)) {
      ++e.outline_steps;
      e.contours_supported += 1;
      m.places.visible[i] = 0;
    }
  }
}

// The outline and the creases on image edges. `found`: what an outline's edge is worth at least.
void add_edges(const ContourMatches& m, double found, Evidence& e) {
  for (int i = 0; i < m.outline_count; ++i) {
    if (!m.edges.found[i]) continue;
    ++e.outline_matches;
    e.outline_offset_px += static_cast<double>(std::fabs(m.edges.offset_px[i]));
    e.contours_supported += found + (1 - found) * nearness(m.edges.offset_px[i]);
  }
  for (int i = m.outline_count; i < m.count; ++i) {
    if (!m.places.visible[i]) continue;
    ++e.creases;
    if (m.edges.found[i]) e.creases_supported += nearness(m.edges.offset_px[i]);
  }
}

void add_contours(const ObjectModel& model, const Scene& scene, const Pose& T,
                  const Viewpoint& view, Evidence& e) {
  ContourMatches m;
  place_contour(model, view, scene, T, kRangePx, 2 * Tolerances(model, scene, T).conflict_mm, m);
  add_outline_steps(scene, m, e);
  if (!scene.with_intensity) return;
  match_edges(scene, kRangePx, m);
  add_edges(m, 0.6, e);
}

// Without depth the outline has to stand for the surface inside it.
void add_contours_alone(const ObjectModel& model, const Scene& scene, const Pose& T,
                        const Viewpoint& view, Evidence& e) {
  ContourMatches m;
  place_contour(model, view, scene, T, kRangePx, 0, m);
  match_edges(scene, kRangePx, m);
  for (int i = 0; i < m.outline_count; ++i) {
    if (!m.places.visible[i]) continue;
    ++e.contours;
    e.outline_bare += !m.edges.found[i];
  }
  keep_directed_edges(scene, m);
  add_edges(m, 0, e);
  simd::SurfaceLook look;
  scene.kernels.look_at_surface(model.surface(view), pose_f(T), scene.depth_map, look);
  const auto inside =
      std::count_if(look.pixel, look.pixel + e.samples, [](int p) { return p >= 0; });
  e.explained_mm2 =
      e.contour_support() * static_cast<double>(view.sample_area_mm2) * static_cast<double>(inside);
}

}  // namespace

simd::SurfaceAgreement surface_agreement(const Scene& scene, const Viewpoint& view,
                                         const SampleArrays& surface, const Pose& T,
                                         const simd::SurfaceTolerance& tolerance) {
  const Vec3 from = -viewing_direction(view);
  simd::SurfaceAgreement found;
  scene.kernels.surface_agreement(
      surface, pose_f(T), scene.depth_map, tolerance,
      {static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())},
      found);
  return found;
}

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T) {
  Evidence e;
  const Viewpoint& view = nearest_viewpoint(model, scene.kernels, T);
  e.seen = scene.modality();
  e.px2_per_mm2 = scene.px2_per_mm2(T.t_mm.z());
  e.samples = static_cast<int>(view.surface_count);
  if (scene.with_depth) {
    add_surface(model, scene, T, view, e);
    add_contours(model, scene, T, view, e);
  } else {
    add_contours_alone(model, scene, T, view, e);
  }
  return e;
}

double depth_residual_mm(const ObjectModel& model, const Scene& scene, const Pose& T) {
  if (!scene.with_depth) return 0;
  const Viewpoint& view = nearest_viewpoint(model, scene.kernels, T);
  simd::SurfaceLook look;
  scene.kernels.look_at_surface(model.surface(view), pose_f(T), scene.depth_map, look);
  const auto conflict_mm = static_cast<float>(Tolerances(model, scene, T).conflict_mm);
  float* end = look.residual_mm;
  for (std::uint32_t i = 0; i < view.surface_count; ++i) {
    const float r = std::fabs(look.residual_mm[i]);
    if (r <= conflict_mm) *end++ = r;
  }
  if (end == look.residual_mm) return 0;
  float* middle = look.residual_mm + (end - look.residual_mm) / 2;
  std::nth_element(look.residual_mm, middle, end);
  return static_cast<double>(*middle);
}

}  // namespace binpick
