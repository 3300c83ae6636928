#include "binpick/geometry/lens_distortion.hpp"

#include <algorithm>

namespace binpick {
namespace {

constexpr int kBorderPoints = 32, kStepsOutward = 128;

// Distance from the centre, as a share of the way to `border`, at which going outward stops leading
// outward in the distorted image; 1: nowhere.
double fold_share(const LensDistortion& lens, const Vec2& border) {
  if (border.isZero()) return 1;
  Vec2 before = lens.distort(Vec2::Zero());
  for (int i = 1; i <= kStepsOutward; ++i) {
    const double share = static_cast<double>(i) / kStepsOutward;
    const Vec2 here = lens.distort(share * border);
    if (!here.allFinite() || (here - before).dot(border) <= 0) return share;
    before = here;
  }
  return 1;
}

}  // namespace

bool LensDistortion::none() const {
  return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0 && k4 == 0 && k5 == 0 && k6 == 0;
}

Vec2 LensDistortion::distort(const Vec2& p) const {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial =
      (1 + ((k3 * r2 + k2) * r2 + k1) * r2) / (1 + ((k6 * r2 + k5) * r2 + k4) * r2);
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

std::optional<double> fold_radius_px(const LensDistortion& lens, const CameraIntrinsics& camera) {
  const auto point = [&](double u, double v) {
    return Vec2((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
  };
  const double right = camera.width - 1, bottom = camera.height - 1;
  std::optional<double> nearest_px;
  for (int i = 0; i <= kBorderPoints; ++i) {
    const double share = static_cast<double>(i) / kBorderPoints;
    for (const Vec2& border : {point(share * right, 0), point(share * right, bottom),
                               point(0, share * bottom), point(right, share * bottom)}) {
      const double fold = fold_share(lens, border);
      if (fold >= 1) continue;
      const double radius_px = fold * Vec2(border.x() * camera.fx, border.y() * camera.fy).norm();
      nearest_px = std::min(nearest_px.value_or(radius_px), radius_px);
    }
  }
  return nearest_px;
}

}  // namespace binpick
