#include "pose/directed_edge.hpp"

#include <cmath>

namespace binpick {
namespace {

// Edge and contour differ by less than about 30 degrees.
constexpr double kDirectionCosMin = 0.87;

}  // namespace

Vec2 gray_gradient(const Scene& scene, const Vec2& pixel) {
  const PyramidLevel& level = scene.intensity;
  const int x = nearest_pixel(pixel.x()), y = nearest_pixel(pixel.y());
  if (x < 1 || y < 1 || x >= level.width - 1 || y >= level.height - 1) return Vec2::Zero();
  const std::uint8_t* at = level.gray + y * level.stride + x;
  const std::uint8_t *above = at - level.stride, *below = at + level.stride;
  const int gx = above[1] + 2 * at[1] + below[1] - above[-1] - 2 * at[-1] - below[-1];
  const int gy = below[-1] + 2 * below[0] + below[1] - above[-1] - 2 * above[0] - above[1];
  return Vec2(gx, gy) / 8;
}

ContourMatch match_directed(const ContourPlace& place, const Scene& scene, int range_px) {
  ContourMatch m = match_contour(place, scene, range_px);
  if (!m.found) return m;
  const Vec2 g = gray_gradient(scene, place.pixel + m.offset_px * place.normal_px);
  m.found = std::abs(g.dot(place.normal_px)) >= kDirectionCosMin * g.norm();
  return m;
}

}  // namespace binpick
