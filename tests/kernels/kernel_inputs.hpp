// Random inputs for the search kernels: orientation maps with a border of zeros, and templates.
#pragma once

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "simd/kernel_table.hpp"

namespace binpick::simd {

inline std::uint8_t random_byte(std::mt19937& random) {
  return static_cast<std::uint8_t>(random() & 0xFF);
}

// Both layouts of the same maps; the block of a pixel is 32 bytes aligned, as in a pyramid.
class KernelMaps {
 public:
  // `density`: how many of 256 pixels have any bits.
  KernelMaps(int width, int height, int border, unsigned density, std::mt19937& random)
      : stride_((width + 2 * border + 64 + 63) / 64 * 64),
        rows_(height + 2 * border + 4),
        gradient_(static_cast<std::size_t>(stride_ * rows_)),
        normal_(gradient_.size()),
        blocks_(gradient_.size() / 4 * kBlockBytes + kBlockBytes),
        origin_(border * stride_ + border) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(origin_ + y * stride_ + x);
        if ((random() & 0xFF) < density) gradient_[i] = random_byte(random);
        if ((random() & 0xFF) < density) normal_[i] = random_byte(random);
      }
    }
    rearrange(width, height, border);
  }

  PlainMaps plain() const {
    return {gradient_.data() + origin_, normal_.data() + origin_, stride_};
  }
  const RearrangedMap& rearranged() const { return rearranged_; }

 private:
  void rearrange(int width, int height, int border) {
    std::uint8_t* aligned = blocks_.data();
    while (reinterpret_cast<std::uintptr_t>(aligned) % kBlockBytes != 0) ++aligned;
    for (int r = 0; r < (height + 2 * border) / 2; ++r) {
      for (int c = 0; c < (width + 2 * border) / 2; ++c) {
        std::uint8_t* out = aligned + (r * (stride_ / 2) + c) * kBlockBytes;
        for (int k = 0; k < 4; ++k) {
          const std::ptrdiff_t from = (2 * r + k) * stride_ + 2 * c;
          std::memcpy(out + 4 * k, gradient_.data() + from, 4);
          std::memcpy(out + 16 + 4 * k, normal_.data() + from, 4);
        }
      }
    }
    const std::ptrdiff_t first = border / 2 * (stride_ / 2) + border / 2;
    rearranged_ = {aligned + first * kBlockBytes, stride_ / 2};
  }

  std::ptrdiff_t stride_, rows_;
  std::vector<std::uint8_t> gradient_, normal_, blocks_;
  std::ptrdiff_t origin_;
  RearrangedMap rearranged_{};
};

// `reach`: largest offset, made even.
inline std::vector<Feature> random_features(int count, int reach, std::mt19937& random) {
  std::vector<Feature> features(static_cast<std::size_t>(count));
  const auto offset = [&] {
    const int half = reach / 2;
    return static_cast<std::int8_t>(2 * (static_cast<int>(random() % (2u * half + 1)) - half));
  };
  for (Feature& f : features) {
    f.x = offset();
    f.y = offset();
    f.gradient_bits = random_byte(random);
    f.normal_bits = random_byte(random);
    f.gradient_weight = static_cast<std::uint8_t>(random() % (kFeatureWeightMax + 1));
    f.normal_weight = static_cast<std::uint8_t>(random() % (kFeatureWeightMax + 1));
  }
  return features;
}

inline std::vector<PlacedFeature> placed(const std::vector<Feature>& features, MapSteps steps,
                                         int scale_q8 = 256) {
  std::vector<PlacedFeature> out(features.size());
  search_kernels_scalar().place_features(features.data(), static_cast<int>(features.size()),
                                         scale_q8, steps, out.data());
  return out;
}

}  // namespace binpick::simd
