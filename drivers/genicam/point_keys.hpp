// Points that compete for pixels, each as one number: the bits of its depth above those of its
// order, above its gray. Read as a double, the smaller number is the nearer point, of equally near
// ones the earlier; so that one minimum moves depth and gray at once, and needs no branch. Depths
// are positive or kNoPoint, hence no key is NaN. The scalar functions are the specification and
// ship; the vector ones give the same bits on every vector unit.
#pragma once

#include <bit>
#include <cstdint>

#include "genicam/point_rows.hpp"

namespace binpick::drivers {

// Orders are below this.
constexpr std::uint32_t kPointOrders = 1u << 24;

inline double point_key(float depth_mm, std::uint32_t order, std::uint8_t gray) {
  const std::uint64_t high = std::bit_cast<std::uint32_t>(depth_mm);
  return std::bit_cast<double>(high << 32 | order << 8 | gray);
}

// What a pixel holds before its first point.
inline double empty_key() {
  return point_key(kNoPoint, 0, 0);
}

// The lowest and the highest target of points that have depth; first > last: there is none.
struct TargetSpan {
  std::int32_t first, last;
};

TargetSpan target_span_scalar(const float* depth_mm, const std::int32_t* target, int count);
// keys[i] of points whose orders are first_order, first_order + 1, ...
void point_keys_scalar(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order,
                       int count, double* keys);
// What pixels hold; 0 in both outputs where that is no point. Leaves the keys empty.
void take_pixels_scalar(double* keys, int count, float* depth_mm, std::uint8_t* gray);

TargetSpan target_span(const float* depth_mm, const std::int32_t* target, int count);
void point_keys(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order,
                int count, double* keys);
void take_pixels(double* keys, int count, float* depth_mm, std::uint8_t* gray);

}  // namespace binpick::drivers
