#include <algorithm>

#include "simd/search_kernels.hpp"

namespace binpick::simd {
namespace {

void scan_row(const PlainMaps& maps, std::ptrdiff_t row_offset, int width,
              const ScanFeature* features, int count, std::uint16_t* gradient_sums,
              std::uint16_t* normal_sums) {
  std::fill_n(gradient_sums, width, std::uint16_t{0});
  std::fill_n(normal_sums, width, std::uint16_t{0});
  for (int i = 0; i < count; ++i) {
    const ScanFeature& f = features[i];
    const std::uint8_t* gradient = maps.gradient + row_offset + f.offset;
    const std::uint8_t* normal = maps.normal + row_offset + f.offset;
    for (int x = 0; x < width; ++x) {
      if (gradient[x] & f.gradient_bits)
        gradient_sums[x] = static_cast<std::uint16_t>(gradient_sums[x] + f.gradient_weight);
      if (normal[x] & f.normal_bits)
        normal_sums[x] = static_cast<std::uint16_t>(normal_sums[x] + f.normal_weight);
    }
  }
}

void match_block_rearranged(const RearrangedMap& map, int x, int y, const Feature* features,
                            int count, int scale_q8, BlockSums& out) {
  out = BlockSums{};
  const std::uint8_t* origin = map.blocks + (y / 2 * map.stride_blocks + x / 2) * kBlockBytes;
  for (int i = 0; i < count; ++i) {
    const Feature& f = features[i];
    const std::uint8_t* block = origin + (scaled_half_offset(f.y, scale_q8) * map.stride_blocks +
                                          scaled_half_offset(f.x, scale_q8)) *
                                             kBlockBytes;
    for (int k = 0; k < 16; ++k) {
      if (block[k] & f.gradient_bits)
        out.gradient[k] = static_cast<std::uint16_t>(out.gradient[k] + f.gradient_weight);
      if (block[16 + k] & f.normal_bits)
        out.normal[k] = static_cast<std::uint16_t>(out.normal[k] + f.normal_weight);
    }
  }
}

void match_block_plain(const PlainMaps& maps, int x, int y, const Feature* features, int count,
                       int scale_q8, BlockSums& out) {
  out = BlockSums{};
  for (int i = 0; i < count; ++i) {
    const Feature& f = features[i];
    const std::ptrdiff_t at = (y + 2 * scaled_half_offset(f.y, scale_q8)) * maps.stride + x +
                              2 * scaled_half_offset(f.x, scale_q8);
    for (int k = 0; k < 16; ++k) {
      const std::ptrdiff_t pixel = at + (k / 4) * maps.stride + k % 4;
      if (maps.gradient[pixel] & f.gradient_bits)
        out.gradient[k] = static_cast<std::uint16_t>(out.gradient[k] + f.gradient_weight);
      if (maps.normal[pixel] & f.normal_bits)
        out.normal[k] = static_cast<std::uint16_t>(out.normal[k] + f.normal_weight);
    }
  }
}

}  // namespace

SearchKernels search_kernels_scalar() {
  return {scan_row, match_block_rearranged, match_block_plain};
}

}  // namespace binpick::simd
