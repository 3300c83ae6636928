#include "simd/feature_kernels.hpp"
#include "simd/gradient_bit.hpp"

namespace binpick::simd {
namespace {

void gradient_row(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                  std::int32_t threshold_squared, std::uint8_t* bits) {
  for (int x = 1; x + 1 < width; ++x) {
    const std::uint8_t *a = row - stride + x, *b = row + x, *c = row + stride + x;
    const std::int32_t gx = (a[1] + 2 * b[1] + c[1]) - (a[-1] + 2 * b[-1] + c[-1]);
    const std::int32_t gy = (c[-1] + 2 * c[0] + c[1]) - (a[-1] + 2 * a[0] + a[1]);
    bits[x] = gx * gx + gy * gy < threshold_squared ? std::uint8_t{0} : gradient_bit(gx, gy);
  }
}

}  // namespace

FeatureKernels feature_kernels_scalar() {
  return {gradient_row};
}

}  // namespace binpick::simd
