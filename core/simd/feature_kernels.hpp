// The kernels of the feature pyramid, row by row. Each exists as a scalar function, which is the
// specification and ships, and as one Highway source compiled for every vector unit; all give the
// same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace binpick::simd {

// Orientation bits of one row of an 8-bit image: 3x3 Sobel, quantized by gradient_bit(); 0 where
// gx^2 + gy^2 < threshold_squared. Writes bits[1 .. width-2]; reads rows[-stride .. stride +
// width).
using GradientRowFn = void (*)(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                               std::int32_t threshold_squared, std::uint8_t* bits);

struct FeatureKernels {
  GradientRowFn gradient_row;
};

// The specification.
FeatureKernels feature_kernels_scalar();
// Compiled for one vector unit; `target_index`: position in Highway's dispatch tables.
FeatureKernels feature_kernels_vector(std::size_t target_index);

}  // namespace binpick::simd
