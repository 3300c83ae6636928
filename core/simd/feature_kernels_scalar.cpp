#include <algorithm>
#include <cmath>

#include "simd/feature_kernels.hpp"
#include "simd/gradient_bit.hpp"
#include "simd/normal_bit.hpp"
#include "simd/surface_slope.hpp"

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

void step_row(ImageView<const float> depth_mm, int y, float noise, std::uint8_t* bits) {
  for (int x = 1; x + 1 < depth_mm.width; ++x) {
    const DepthStep step = depth_step(depth_mm, x, y, noise);
    bits[x] = step.edge ? gradient_bit(static_cast<std::int32_t>(step.gx * 1024),
                                       static_cast<std::int32_t>(step.gy * 1024))
                        : std::uint8_t{0};
  }
}

void fit_row(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int y,
             const NormalRow& to) {
  for (int x = 2; x + 2 < depth_mm.width; ++x) {
    const RayNormal n = fit_ray_normal(depth_mm, camera, x, y);
    to.x[x] = n.x;
    to.y[x] = n.y;
    to.valid[x] = n.valid;
  }
}

void normal_bits_row(NormalCodebook codebook, const NormalRow& from, int width,
                     std::uint8_t* bits) {
  for (int x = 0; x < width; ++x)
    bits[x] = from.valid[x] ? normal_bit(codebook, from.x[x], from.y[x]) : std::uint8_t{0};
}

void pool_row(const NormalRow& from, std::ptrdiff_t stride, int width, const NormalRow& to) {
  // Invalid ones add nothing: they are 0.
  const auto sum = [&](const auto* upper, int x) {
    const auto* lower = upper + stride;
    return upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
  };
  for (int x = 0; x < width; ++x) {
    const int count = sum(from.valid, x);
    const auto share = static_cast<float>(std::max(count, 1));
    to.valid[x] = count >= 2;
    to.x[x] = count >= 2 ? sum(from.x, x) / share : 0.0f;
    to.y[x] = count >= 2 ? sum(from.y, x) / share : 0.0f;
  }
}

float merged_depth(const float (&z)[4]) {
  float nearest = kDepthMax_mm;
  int valid = 0;
  for (float v : z) {
    if (!(v > 0)) continue;
    nearest = std::min(nearest, v);
    ++valid;
  }
  if (valid < 2) return 0;
  const float limit = nearest * (1 + kSameSurfaceRatio);
  float near_sum = 0, far_sum = 0;
  int near_count = 0;
  for (float v : z) {
    if (!(v > 0)) continue;
    (v <= limit ? near_sum : far_sum) += v;
    near_count += v <= limit;
  }
  const int far_count = valid - near_count;
  if (near_count >= 2 || far_count < 2) return near_sum / static_cast<float>(near_count);
  return far_sum / static_cast<float>(far_count);
}

void halve_row(const float* from_mm, std::ptrdiff_t stride, int width, float* to_mm) {
  for (int x = 0; x < width; ++x) {
    const float *upper = from_mm + 2 * x, *lower = upper + stride;
    to_mm[x] = merged_depth({upper[0], upper[1], lower[0], lower[1]});
  }
}

void add_difference(float before, float here, float after, Roughness& sum) {
  if (!(before > 0 && here > 0 && after > 0)) return;
  const float limit = here * kSameSurfaceRatio;
  if (std::fabs(before - here) > limit || std::fabs(after - here) > limit) return;
  sum.total += std::fabs(1 / before - 2 / here + 1 / after);
  ++sum.count;
}

Roughness roughness(ImageView<const float> depth_mm, int left, int top, int step) {
  const int first = std::max(top, step),
            last = std::min(top + kNoiseTilePx, depth_mm.height - step);
  const std::ptrdiff_t down = step * depth_mm.stride;
  Roughness sum;
  for (int x = left; x < left + kNoiseTilePx; ++x) {
    Roughness column;
    if (x >= step && x < depth_mm.width - step) {
      for (int y = first; y < last; ++y) {
        const float* z = depth_mm.row(y) + x;
        add_difference(z[-step], *z, z[step], column);
        add_difference(z[-down], *z, z[down], column);
      }
    }
    sum.total += column.total;
    sum.count += column.count;
  }
  return sum;
}

}  // namespace

FeatureKernels feature_kernels_scalar() {
  return {gradient_row, step_row, fit_row, normal_bits_row, pool_row, halve_row, roughness};
}

}  // namespace binpick::simd
