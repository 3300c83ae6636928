// Quantization of directions into eight orientation bins, hard (one bit, for input images) and soft
// (interpolated weights, for the training histograms; paper section III-A, third step).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "binpick/model/normal_codebook.hpp"
#include "simd/gradient_bit.hpp"
#include "simd/normal_bit.hpp"

namespace binpick {

inline constexpr int kOrientationBins = 8;
// Of edges, which have no direction: half a turn has all bins.
inline constexpr float kBinsPerRad = kOrientationBins / std::numbers::pi_v<float>;

// Up to three bins with weights that sum to 1. count 0: no orientation.
struct SoftBins {
  int count = 0;
  std::uint8_t bin[3] = {0, 0, 0};
  float weight[3] = {0, 0, 0};
};

// Gradients have no sign here: the contrast of a contour depends on what lies behind the part.
// Eight bins over 180 degrees; bin i is centred at i * 22.5 degrees, measured from +x towards +y
// (image axes).
SoftBins soft_gradient_bins(float angle_rad);

// Normals are in the frame of their own viewing ray (z along the ray). They are given by tilt and
// azimuth, so that a roll of the image only adds to the azimuth.
SoftBins soft_normal_bins(NormalCodebook codebook, float tilt_sin, float azimuth_rad);

}  // namespace binpick
