#include "features/depth_noise.hpp"

#include <algorithm>

namespace binpick {
namespace {

// Of the tiles, those that are smoother than the rest: flat surface, and what noise is left on it.
constexpr double kSmoothestShare = 0.1;
constexpr int kTilesMin = 4;
// Second differences that a tile must have to count.
constexpr int kDifferencesMin = simd::kNoiseTilePx * simd::kNoiseTilePx;
// Of a normal distribution: mean of |x - 2y + z| in standard deviations.
constexpr double kMeanOfDifference = 1.9544;
constexpr int kSteps[2] = {1, 2};

// Of the mean second differences of the tiles; those that are negative are unknown.
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

DepthNoise estimate_depth_noise(ImageView<const float> depth, const simd::FeatureKernels& kernels,
                                std::span<float> scratch, WorkerPool& pool) {
  constexpr int kSide = simd::kNoiseTilePx;
  const int columns = depth.width / kSide, rows = depth.height / kSide;
  const std::size_t tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const std::span<float> roughness[2] = {scratch.first(tiles), scratch.subspan(tiles, tiles)};
  pool.parallel_for(rows, [&](int r, int) {
    for (int c = 0; c < columns; ++c) {
      for (int k = 0; k < 2; ++k) {
        const simd::Roughness sum = kernels.roughness(depth, c * kSide, r * kSide, kSteps[k]);
        roughness[k][static_cast<std::size_t>(r * columns + c)] =
            sum.count >= kDifferencesMin ? sum.total / static_cast<float>(sum.count) : -1;
      }
    }
  });
  return {smooth_share(roughness[0]), smooth_share(roughness[1])};
}

}  // namespace binpick
