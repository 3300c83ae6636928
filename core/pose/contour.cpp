#include "pose/contour.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kRangeMax = 12;
// Contrast over two pixels below which an intensity edge is noise.
constexpr float kContrastMin = 8;

// Places in an image in 1/65536 px, weights between pixels in 1/2048 px: whole numbers are faster.
constexpr int kPlaceBits = 16, kWeightBits = 11;
int fixed_place(double px) {
  return static_cast<int>(px * (1 << kPlaceBits));
}

float gray_at(const PyramidLevel& level, int u, int v) {
  constexpr int kOne = 1 << kWeightBits, kBelow = kPlaceBits - kWeightBits;
  const int fx = (u >> kBelow) & (kOne - 1), fy = (v >> kBelow) & (kOne - 1);
  const std::uint8_t* p = level.gray + (v >> kPlaceBits) * level.stride + (u >> kPlaceBits);
  const std::uint8_t* q = p + level.stride;
  const int top = p[0] * (kOne - fx) + p[1] * fx, bottom = q[0] * (kOne - fx) + q[1] * fx;
  constexpr float kScale = 1.0f / (1 << 2 * kWeightBits);
  return static_cast<float>(top * (kOne - fy) + bottom * fy) * kScale;
}

}  // namespace

ContourPlace place_contour(const ContourSample& sample, const Scene& scene, const Pose& T,
                           int range_px, double depth_tolerance_mm) {
  ContourPlace place;
  place.point_cam = T * position_of(sample);
  const Vec3 tangent = T.R * tangent_of(sample);
  const CameraIntrinsics& camera = scene.intensity.camera;
  const Vec3& p = place.point_cam;
  place.pixel = camera.project(p);
  // Image of the tangent: derivative of the projection.
  const Vec2 along(camera.fx * (tangent.x() - p.x() / p.z() * tangent.z()),
                   camera.fy * (tangent.y() - p.y() / p.z() * tangent.z()));
  const double length = along.norm();
  if (length < 1e-6 * camera.fx) return place;
  place.normal_px = Vec2(-along.y(), along.x()) / length;
  const double margin = std::min(range_px, kRangeMax) + 3;
  // In the negative, so that a pixel that is not a number lies outside too.
  if (!(place.pixel.x() >= margin && place.pixel.y() >= margin &&
        place.pixel.x() <= scene.intensity.width - 2 - margin &&
        place.pixel.y() <= scene.intensity.height - 2 - margin)) {
    return place;
  }
  const double z = scene.measured_at(p).depth_mm;
  place.visible = !(z > 0 && z < p.z() - depth_tolerance_mm);
  return place;
}

ContourMatch match_contour(const ContourPlace& place, const Scene& scene, int range_px) {
  ContourMatch m;
  range_px = std::min(range_px, kRangeMax);
  float profile[2 * kRangeMax + 3];
  const int samples = 2 * range_px + 3;
  const int du = fixed_place(place.normal_px.x()), dv = fixed_place(place.normal_px.y());
  int u = fixed_place(place.pixel.x()) - (range_px + 1) * du,
      v = fixed_place(place.pixel.y()) - (range_px + 1) * dv;
  for (int i = 0; i < samples; ++i, u += du, v += dv) profile[i] = gray_at(scene.intensity, u, v);
  // The strongest step, nearer ones preferred.
  float best = 0;
  int at = -1;
  auto contrast = [&](int i) { return std::fabs(profile[i + 1] - profile[i - 1]); };
  for (int i = 1; i + 1 < samples; ++i) {
    const float c = contrast(i);
    if (c < kContrastMin) continue;
    const float away = static_cast<float>(i - range_px - 1) / static_cast<float>(range_px + 1);
    const float value = std::min(c, 60.0f) * (1 - 0.7f * away * away);
    if (value > best) {
      best = value;
      at = i;
    }
  }
  if (at < 0) return m;
  double offset = at - range_px - 1;
  if (at > 1 && at + 2 < samples) {  // vertex of the parabola through three contrasts
    const float l = contrast(at - 1), c = contrast(at), r = contrast(at + 1);
    const float bend = l - 2 * c + r;
    if (bend < -1e-3f) offset += std::clamp(0.5 * static_cast<double>((l - r) / bend), -0.5, 0.5);
  }
  m.found = true;
  m.offset_px = offset;
  return m;
}

int edge_direction(const Vec2& normal) {
  return static_cast<int>(std::atan2(normal.y(), normal.x()) * 8 / kPi + 16.5) & 7;
}

unsigned edge_directions_near(const Vec2& normal) {
  const int bin = edge_direction(normal);
  return (1u << bin) | (1u << ((bin + 1) & 7)) | (1u << ((bin + 7) & 7));
}

Vec3 pulled_back(const ContourPlace& place, const CameraIntrinsics& camera) {
  const Vec3& p = place.point_cam;
  const double a = place.normal_px.x() * camera.fx / p.z(),
               b = place.normal_px.y() * camera.fy / p.z();
  return {a, b, -(a * p.x() + b * p.y()) / p.z()};
}

int add_contour_residuals(const Viewpoint& view, const ObjectModel& model, const Scene& scene,
                          const Pose& T, int range_px, double sigma_px, double depth_tolerance_mm,
                          NormalEquations& equations) {
  const CameraIntrinsics& camera = scene.intensity.camera;
  int found = 0;
  for (const ContourSample& sample : model.contour(view)) {
    const ContourPlace place = place_contour(sample, scene, T, range_px, depth_tolerance_mm);
    if (!place.visible) continue;
    const ContourMatch m = match_contour(place, scene, range_px);
    if (!m.found) continue;
    const Vec3 n = pulled_back(place, camera);
    equations.add(point_gradient(n, place.point_cam, T.t_mm) / sigma_px, -m.offset_px / sigma_px,
                  robust_weight(m.offset_px, range_px));
    ++found;
  }
  return found;
}

}  // namespace binpick
