#include "features/orientation.hpp"

#include <algorithm>
#include <numbers>

namespace binpick {
namespace {

// Around kFacingTiltSin the histogram weight passes linearly from the facing cell to the ring.
constexpr float kFacingBlend = 0.10f;

// Weights of the two bins around position `p` (in bins) on a ring of `bins` bins that starts at
// `first`.
void ring_bins(float p, int bins, int first, float scale, SoftBins& out) {
  const float whole = std::floor(p);
  const float fraction = p - whole;
  const int i = ((static_cast<int>(whole) % bins) + bins) % bins;
  out.bin[out.count] = static_cast<std::uint8_t>(first + i);
  out.weight[out.count++] = (1 - fraction) * scale;
  out.bin[out.count] = static_cast<std::uint8_t>(first + (i + 1) % bins);
  out.weight[out.count++] = fraction * scale;
}

}  // namespace

SoftBins soft_gradient_bins(float angle_rad) {
  SoftBins out;
  ring_bins(angle_rad * kBinsPerRad, kOrientationBins, 0, 1.0f, out);
  return out;
}

SoftBins soft_normal_bins(NormalCodebook codebook, float tilt_sin, float azimuth_rad) {
  SoftBins out;
  const float turn = azimuth_rad / (2 * std::numbers::pi_v<float>);
  if (codebook == NormalCodebook::kAzimuth) {
    if (tilt_sin >= kAzimuthTiltSinMin) ring_bins(turn * 8, 8, 0, 1.0f, out);
    return out;
  }
  const float ring =
      std::clamp((tilt_sin - kFacingTiltSin) / (2 * kFacingBlend) + 0.5f, 0.0f, 1.0f);
  if (ring < 1) {
    out.bin[out.count] = 0;
    out.weight[out.count++] = 1 - ring;
  }
  if (ring > 0) ring_bins(turn * 7, 7, 1, ring, out);
  return out;
}

}  // namespace binpick
