#include "gate/reference_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace binpick {
namespace {

constexpr int kWidth = 800, kHeight = 480;  // a region of interest
constexpr int kOffsets = 60;                // features of a template

}  // namespace

ReferenceKernel::ReferenceKernel()
    : masks_(kWidth * kHeight), counts_(kWidth * kHeight), depth_(kWidth * kHeight) {
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < masks_.size(); ++i) {
    state = state * 1664525u + 1013904223u;
    masks_[i] = static_cast<std::uint8_t>(state >> 24);
    depth_[i] = 600 + static_cast<float>(state >> 22) * 0.01f;
  }
}

void ReferenceKernel::count_bits() {
  std::fill(counts_.begin(), counts_.end(), std::uint8_t{0});
  for (int k = 0; k < kOffsets; ++k) {
    const std::uint8_t bit = static_cast<std::uint8_t>(1 << k % 8);
    const std::size_t shift = static_cast<std::size_t>(k) * (kWidth + 7) / 2;
    const std::size_t count = masks_.size() - shift;
    for (std::size_t i = 0; i < count; ++i)
      counts_[i] = static_cast<std::uint8_t>(counts_[i] + ((masks_[i + shift] & bit) != 0));
  }
}

double ReferenceKernel::fit_planes() {
  double sum = 0;
  for (int y = 2; y < kHeight - 2; ++y) {
    const float* row = &depth_[static_cast<std::size_t>(y * kWidth)];
    for (int x = 2; x < kWidth - 2; ++x) {
      const float dx = row[x + 2] - row[x - 2];
      const float dy = row[x + 2 * kWidth] - row[x - 2 * kWidth];
      const float length = std::sqrt(dx * dx + dy * dy + 1);
      if (counts_[static_cast<std::size_t>(y * kWidth + x)] > kOffsets / 2) sum += 1 / length;
    }
  }
  return sum;
}

double ReferenceKernel::run() {
  count_bits();
  return fit_planes();
}

}  // namespace binpick
