#include <array>

#include "check/checks.hpp"

namespace binpick {
namespace {

constexpr int kSide = 96;        // samples along each side of the region
constexpr double kRim = 0.005;   // share of pixels that is left out at both ends
constexpr int kBlackBelow = 16;  // 12 significant bits of 16 come to this
constexpr int kWhiteFrom = 254;
constexpr double kSaturatedShare = 0.4, kAllSaturatedShare = 0.98;
constexpr int kFlatWithin = 2;

struct Histogram {
  std::array<int, 256> count{};
  int total = 0;

  int quantile(double share) const {
    const double wanted = share * (total - 1);
    int value = 0;
    for (int below = count[0]; below <= wanted && value < 255;
         below += count[static_cast<std::size_t>(value)])
      ++value;
    return value;
  }
  double share_from(int value) const {
    int sum = 0;
    for (int v = value; v < 256; ++v) sum += count[static_cast<std::size_t>(v)];
    return static_cast<double>(sum) / total;
  }
};

Histogram histogram_of(const ImageView<const std::uint8_t>& image, const PixelRange& region) {
  Histogram histogram;
  const int step_x = sample_step(region.x1 - region.x0, kSide);
  const int step_y = sample_step(region.y1 - region.y0, kSide);
  int rows = 0;
  for (int y = region.y0 + step_y / 2; y < region.y1; y += step_y) {
    const std::uint8_t* row = image.row(y);
    for (int x = region.x0 + sample_begin(rows++, step_x); x < region.x1; x += step_x) {
      ++histogram.count[row[x]];
      ++histogram.total;
    }
  }
  return histogram;
}

}  // namespace

void check_intensity(const Frame& frame, const PixelRange& region, FrameFindings& findings) {
  const Histogram histogram = histogram_of(frame.intensity, region);
  const bool alone = frame.depth_mm.empty();
  const int darkest = histogram.quantile(kRim), brightest = histogram.quantile(1 - kRim);
  const double saturated = histogram.share_from(kWhiteFrom);
  if (brightest < kBlackBelow) {
    findings.add({FindingCode::kIntensityBlack, alone, -1, {static_cast<double>(brightest)}});
  } else if (saturated >= kSaturatedShare) {
    const bool refuses = alone && saturated >= kAllSaturatedShare;
    findings.add({FindingCode::kIntensitySaturated, refuses, -1, {saturated}});
  } else if (brightest - darkest <= kFlatWithin) {
    findings.add({FindingCode::kIntensityFlat, false, -1, {static_cast<double>(brightest)}});
  }
}

}  // namespace binpick
