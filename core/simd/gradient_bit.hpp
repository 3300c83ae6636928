// The orientation bin of an image gradient. Gradients have no sign here: eight bins over 180
// degrees; bin i is centred at i * 22.5 degrees, measured from +x towards +y.
#pragma once

#include <cstdint>

namespace binpick {

// Bit of the bin nearest to the direction (gx, gy); (0, 0) gives 0. Exact for |gx|, |gy| < 2^16:
// the scalar specification of the vector kernel.
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

}  // namespace binpick
