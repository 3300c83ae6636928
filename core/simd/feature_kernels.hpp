// The kernels of the feature pyramid, row by row. Each exists as a scalar function, which is the
// specification and ships, and as one Highway source compiled for every vector unit; all give the
// same bits.
//
// Unless stated otherwise a kernel reads and writes just the pixels that it names, starts at any
// address, and takes any width from 0 on; what it reads and what it writes do not overlap. A depth
// is in mm: 0 where nothing was measured, or between kDepthMin_mm and kDepthMax_mm.
#pragma once

#include <cstddef>
#include <cstdint>

#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/camera_model.hpp"
#include "binpick/model/normal_codebook.hpp"

namespace binpick::simd {

// Within these single precision neither overflows nor vanishes in what the kernels compute.
inline constexpr float kDepthMin_mm = 1e-3f, kDepthMax_mm = 1e6f;

// Orientation bits of one row of an 8-bit image: 3x3 Sobel, quantized by gradient_bit(); 0 where
// gx^2 + gy^2 < threshold_squared. Writes bits[1 .. width-2]; reads rows[-stride .. stride +
// width).
using GradientRowFn = void (*)(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                               std::int32_t threshold_squared, std::uint8_t* bits);

// Orientation bits of the depth steps of row y: depth_step() and gradient_bit() of 1024 times its
// direction; 0 where there is no step. Row y has one above and one below it. Writes
// bits[1 .. width-2].
using StepRowFn = void (*)(ImageView<const float> depth_mm, int y, float noise, std::uint8_t* bits);

// A row of normals. x and y are 0 where valid is 0; else valid is 1.
struct NormalRow {
  float *x, *y;
  std::uint8_t* valid;
};

// fit_ray_normal() of row y, which has two rows above and two below it. Writes 2 .. width-3.
using FitRowFn = void (*)(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int y,
                          const NormalRow& to);

// normal_bit() of the valid normals, 0 of the others. Writes bits[0 .. width-1].
using NormalBitsRowFn = void (*)(NormalCodebook codebook, const NormalRow& from, int width,
                                 std::uint8_t* bits);

// 2x2 pixels as one: the mean of their valid normals, invalid with fewer than two. Reads
// 0 .. 2 width - 1 of `from` and of the row `stride` elements after it; writes 0 .. width-1.
using PoolRowFn = void (*)(const NormalRow& from, std::ptrdiff_t stride, int width,
                           const NormalRow& to);

// 2x2 pixels as one, as above. Depth: the mean of the nearer surface, unless only one pixel shows
// it and two show another; 0 with fewer than two measured.
using HalveRowFn = void (*)(const float* from_mm, std::ptrdiff_t stride, int width, float* to_mm);

// Second differences of 1/z over the square of kNoiseTilePx pixels with its corner at (left, top),
// along rows and columns, between pixels `step` apart (1 or 2) that all lie on one surface. The
// tile is inside the image; pixels less than `step` from the image's border count as neighbours
// only. Summed column by column: first those down each column, then the columns. Reads, and
// ignores, up to two pixels before and after a row, other than the first and the last.
inline constexpr int kNoiseTilePx = 24;
struct Roughness {
  float total = 0;  // of the absolute differences
  int count = 0;
};
using RoughnessFn = Roughness (*)(ImageView<const float> depth_mm, int left, int top, int step);

struct FeatureKernels {
  GradientRowFn gradient_row;
  StepRowFn step_row;
  FitRowFn fit_row;
  NormalBitsRowFn normal_bits_row;
  PoolRowFn pool_row;
  HalveRowFn halve_row;
  RoughnessFn roughness;
};

// The specification.
FeatureKernels feature_kernels_scalar();
// Compiled for one vector unit; `target_index`: position in Highway's dispatch tables.
FeatureKernels feature_kernels_vector(std::size_t target_index);

}  // namespace binpick::simd
