// Quantization of directions into eight orientation bins, hard (one bit, for input images) and soft
// (interpolated weights, for the training histograms; paper section III-A, third step).
#pragma once

#include <cmath>
#include <cstdint>

#include "binpick/model/normal_codebook.hpp"

namespace binpick {

inline constexpr int kOrientationBins = 8;
inline constexpr float kPi = 3.14159265358979f;

// Up to three bins with weights that sum to 1. count 0: no orientation.
struct SoftBins {
  int count = 0;
  std::uint8_t bin[3] = {0, 0, 0};
  float weight[3] = {0, 0, 0};
};

// Gradients have no sign here: the contrast of a contour depends on what lies behind the part. Eight bins over
// 180 degrees; bin i is centred at i * 22.5 degrees, measured from +x towards +y (image axes).
SoftBins soft_gradient_bins(float angle_rad);

// Bit of the bin nearest to the direction (gx, gy); (0, 0) gives 0. Exact for |gx|, |gy| < 2^18: the scalar
// specification of the vector kernel.
inline std::uint8_t gradient_bit(std::int32_t gx, std::int32_t gy) {
  if (gx == 0 && gy == 0) return 0;
  if (gy < 0 || (gy == 0 && gx < 0)) {  // into the upper half plane: angle in [0, 180)
    gx = -gx;
    gy = -gy;
  }
  const std::int32_t ax = gx < 0 ? -gx : gx;
  // Sector boundaries at 11.25 + k * 22.5 degrees: tangents in units of 1/4096.
  int sector = 0;
  if (gy * 4096 >= ax * 815) ++sector;    // 11.25
  if (gy * 4096 >= ax * 2737) ++sector;   // 33.75
  if (gy * 4096 >= ax * 6130) ++sector;   // 56.25
  if (gy * 4096 >= ax * 20592) ++sector;  // 78.75
  const int bin = gx < 0 ? (8 - sector) & 7 : sector;
  return static_cast<std::uint8_t>(1u << bin);
}

// Normals are given in the frame of their own viewing ray (z along the ray), by the components (nx, ny) of the
// unit normal; the third one points at the camera. The soft bins take them as tilt and azimuth, so
// that a roll of the image only adds to the azimuth.
SoftBins soft_normal_bins(NormalCodebook codebook, float tilt_sin, float azimuth_rad);
std::uint8_t normal_bit(NormalCodebook codebook, float nx, float ny);

}  // namespace binpick
