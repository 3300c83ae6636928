#include "pose/contour.hpp"

#include <cmath>

#include "pose/view_lookup.hpp"
#include "simd/gradient_bit.hpp"

namespace binpick {
namespace {

// Between an edge's direction and the contour's: 30 degrees.
constexpr float kDirectionCosMin = 0.87f;
// From a place to the border of the image, beyond the range that is looked at.
constexpr int kMarginPx = 3;

struct Gradient {
  int x, y;
};

// 3x3 Sobel at a pixel of level 0; none at the border.
Gradient gray_gradient(const Scene& scene, float u, float v) {
  const PyramidLevel& level = scene.intensity;
  const int x = nearest_pixel(static_cast<double>(u)), y = nearest_pixel(static_cast<double>(v));
  if (x < 1 || y < 1 || x >= level.width - 1 || y >= level.height - 1) return {0, 0};
  const std::uint8_t* at = level.gray + y * level.stride + x;
  const std::uint8_t *above = at - level.stride, *below = at + level.stride;
  return {above[1] + 2 * at[1] + below[1] - above[-1] - 2 * at[-1] - below[-1],
          below[-1] + 2 * below[0] + below[1] - above[-1] - 2 * above[0] - above[1]};
}

}  // namespace

void place_contour(const ObjectModel& model, const Viewpoint& view, const Scene& scene,
                   const Pose& T, int range_px, double hidden_mm, ContourMatches& out) {
  const SampleArrays samples = model.contour(view);
  out.count = samples.count;
  out.outline_count = static_cast<int>(view.outline_count);
  scene.kernels.place_contour(samples, pose_f(T), scene.gray_map, scene.depth_map,
                              static_cast<float>(range_px + kMarginPx),
                              static_cast<float>(hidden_mm), out.places);
}

void match_edges(const Scene& scene, int range_px, ContourMatches& m) {
  scene.kernels.match_edges(m.places, m.count, scene.gray_map, range_px, m.edges);
}

void keep_directed_edges(const Scene& scene, ContourMatches& m) {
  for (int i = 0; i < m.count; ++i) {
    if (!m.edges.found[i]) continue;
    const float nu = m.places.normal_u[i], nv = m.places.normal_v[i];
    const auto [x, y] = gray_gradient(scene, m.places.u[i] + m.edges.offset_px[i] * nu,
                                      m.places.v[i] + m.edges.offset_px[i] * nv);
    const float gx = static_cast<float>(x), gy = static_cast<float>(y);
    const float across = std::fabs(gx * nu + gy * nv);
    if (across < kDirectionCosMin * std::sqrt(gx * gx + gy * gy)) m.edges.found[i] = 0;
  }
}

unsigned edge_directions_near(float normal_u, float normal_v) {
  const unsigned bit = gradient_bit(static_cast<std::int32_t>(normal_u * 4096),
                                    static_cast<std::int32_t>(normal_v * 4096));
  return (bit | bit << 1 | bit >> 1 | bit << 7 | bit >> 7) & 0xFF;  // bins 7 and 0 are neighbours
}

}  // namespace binpick
