#include "eval/distance_range.hpp"

#include <algorithm>
#include <cmath>

namespace binpick::app {
namespace {

constexpr int kStep_px = 3;  // every third pixel of every third row is plenty
constexpr std::size_t kSamplesMin = 100;
constexpr double kTailShare = 0.01;
constexpr double kRounding_mm = 10.0;
constexpr double kApparent_px_min = 40.0;  // five pixels at the top of the pyramid

}  // namespace

std::optional<DistanceRange> measured_range(const Frame& frame) {
  const ImageView<const float>& depth = frame.depth_mm;
  const auto [x0, y0, x1, y1] = pixels_of(frame.roi, depth.width, depth.height);
  std::vector<double> distances;
  for (int y = y0; y < y1; y += kStep_px) {
    for (int x = x0; x < x1; x += kStep_px) {
      const float z = depth.at(x, y);
      if (is_measured(z)) distances.push_back(frame.camera.unproject(x, y, z).norm());
    }
  }
  if (distances.size() < kSamplesMin) return std::nullopt;
  const auto percentile = [&distances](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(distances.size() - 1));
    std::nth_element(distances.begin(), distances.begin() + k, distances.end());
    return distances[static_cast<std::size_t>(k)];
  };
  return DistanceRange{percentile(kTailShare), percentile(1 - kTailShare)};
}

std::optional<DistanceRange> training_range(const std::vector<DistanceRange>& measured,
                                            double diameter_mm, const CameraIntrinsics& camera) {
  if (measured.empty()) return std::nullopt;
  DistanceRange range = measured.front();
  for (const DistanceRange& m : measured) {
    range.min_mm = std::min(range.min_mm, m.min_mm);
    range.max_mm = std::max(range.max_mm, m.max_mm);
  }
  const double fills_image_mm = diameter_mm * camera.fx / std::max(camera.width, camera.height);
  const double nearest_mm = std::max({range.min_mm - diameter_mm / 2, fills_image_mm, diameter_mm});
  const double farthest_mm =
      std::min(range.max_mm + diameter_mm / 2, diameter_mm * camera.fx / kApparent_px_min);
  range.min_mm = kRounding_mm * std::floor(nearest_mm / kRounding_mm);
  range.max_mm = kRounding_mm * std::ceil(farthest_mm / kRounding_mm);
  range.max_mm = std::max(range.max_mm, range.min_mm + kRounding_mm);
  return range;
}

}  // namespace binpick::app
