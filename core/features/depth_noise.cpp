#include "features/depth_noise.hpp"

#include <algorithm>
#include <cmath>

#include "features/surface_slope.hpp"

namespace binpick {
namespace {

// Of the tiles, those that are smoother than the rest: flat surface, and what noise is left on it.
constexpr double kSmoothestShare = 0.1;
constexpr int kTilesMin = 4;
// Second differences that a tile must have to count.
constexpr int kDifferencesMin = kNoiseTilePx * kNoiseTilePx;
// Of a normal distribution: mean of |x - 2y + z| in standard deviations.
constexpr double kMeanOfDifference = 1.9544;
constexpr int kSteps[2] = {1, 2};

struct Sum {
  float total = 0;
  int count = 0;

  void add(float before, float here, float after) {
    if (!(before > 0 && after > 0)) return;
    const float limit = here * kSameSurfaceRatio;
    if (std::fabs(before - here) > limit || std::fabs(after - here) > limit) return;
    total += std::fabs(1 / before - 2 / here + 1 / after);
    ++count;
  }
};

// Mean of the second differences over a tile, along rows and columns; -1 where they are too few.
float tile_roughness(ImageView<const float> depth, int left, int top, int step) {
  const std::ptrdiff_t down = step * depth.stride;
  Sum sum;
  for (int y = std::max(top, step); y < std::min(top + kNoiseTilePx, depth.height - step); ++y) {
    const float* row = depth.row(y);
    for (int x = std::max(left, step); x < std::min(left + kNoiseTilePx, depth.width - step); ++x) {
      const float* z = row + x;
      if (!(*z > 0)) continue;
      sum.add(z[-step], *z, z[step]);
      sum.add(z[-down], *z, z[down]);
    }
  }
  return sum.count >= kDifferencesMin ? sum.total / static_cast<float>(sum.count) : -1;
}

double smooth_share(std::span<float> roughness) {
  const auto end =
      std::remove_if(roughness.begin(), roughness.end(), [](float r) { return r < 0; });
  const auto count = end - roughness.begin();
  if (count < kTilesMin) return 0;
  const auto at =
      roughness.begin() + static_cast<std::ptrdiff_t>(kSmoothestShare * static_cast<double>(count));
  std::nth_element(roughness.begin(), at, end);
  return static_cast<double>(*at) / kMeanOfDifference;
}

}  // namespace

DepthNoise estimate_depth_noise(ImageView<const float> depth, std::span<float> scratch,
                                WorkerPool& pool) {
  const int columns = depth.width / kNoiseTilePx, rows = depth.height / kNoiseTilePx;
  const std::size_t tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const std::span<float> roughness[2] = {scratch.first(tiles), scratch.subspan(tiles, tiles)};
  pool.parallel_for(rows, [&](int r, int) {
    for (int c = 0; c < columns; ++c) {
      const std::size_t i = static_cast<std::size_t>(r * columns + c);
      for (int k = 0; k < 2; ++k)
        roughness[k][i] = tile_roughness(depth, c * kNoiseTilePx, r * kNoiseTilePx, kSteps[k]);
    }
  });
  return {smooth_share(roughness[0]), smooth_share(roughness[1])};
}

}  // namespace binpick
