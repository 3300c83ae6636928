#include <algorithm>
#include <limits>

#include "genicam/point_keys.hpp"

namespace binpick::drivers {

TargetSpan target_span_scalar(const float* depth_mm, const std::int32_t* target, int count) {
  TargetSpan span{std::numeric_limits<std::int32_t>::max(), -1};
  for (int i = 0; i < count; ++i) {
    if (!(depth_mm[i] < kNoPoint)) continue;
    span.first = std::min(span.first, target[i]);
    span.last = std::max(span.last, target[i]);
  }
  return span;
}

void point_keys_scalar(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order,
                       int count, double* keys) {
  for (int i = 0; i < count; ++i)
    keys[i] = point_key(depth_mm[i], first_order + static_cast<std::uint32_t>(i), gray[i]);
}

void take_pixels_scalar(double* keys, int count, float* depth_mm, std::uint8_t* gray) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t key = std::bit_cast<std::uint64_t>(keys[i]);
    const float depth = std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
    depth_mm[i] = depth < kNoPoint ? depth : 0.0f;
    gray[i] = static_cast<std::uint8_t>(key);
    keys[i] = empty_key();
  }
}

}  // namespace binpick::drivers
