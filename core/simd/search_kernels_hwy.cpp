// The vector kernels: this file is compiled once per vector unit by foreach_target.
// search_kernels.hpp states what each function does; the scalar code is what it must agree with bit
// for bit.
#include "simd/search_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/search_kernels_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

void ScanRow(const PlainMaps& maps, std::ptrdiff_t row_offset, int width,
             const ScanFeature* features, int count, std::uint16_t* gradient_sums,
             std::uint16_t* normal_sums) {
  search_kernels_scalar().scan_row(maps, row_offset, width, features, count, gradient_sums,
                                   normal_sums);
}
void MatchBlockRearranged(const RearrangedMap& map, int x, int y, const Feature* features,
                          int count, int scale_q8, BlockSums& out) {
  search_kernels_scalar().match_block_rearranged(map, x, y, features, count, scale_q8, out);
}
void MatchBlockPlain(const PlainMaps& maps, int x, int y, const Feature* features, int count,
                     int scale_q8, BlockSums& out) {
  search_kernels_scalar().match_block_plain(maps, x, y, features, count, scale_q8, out);
}

#else

// Byte sums of weights up to 31 stay below 256 for this many features; then they are widened.
constexpr int kFeaturesPerByteSum = 8;

void ScanRow(const PlainMaps& maps, std::ptrdiff_t row_offset, int width,
             const ScanFeature* features, int count, std::uint16_t* gradient_sums,
             std::uint16_t* normal_sums) {
  const hn::CappedTag<std::uint8_t, 64> d8;
  const hn::Repartition<std::uint16_t, decltype(d8)> d16;
  const hn::Half<decltype(d8)> half8;
  const int lanes = static_cast<int>(hn::Lanes(d8));
  const int half = lanes / 2;
  for (int x = 0; x < width; x += lanes) {
    auto gradient_low = hn::Zero(d16), gradient_high = hn::Zero(d16);
    auto normal_low = hn::Zero(d16), normal_high = hn::Zero(d16);
    const std::uint8_t* gradient_at = maps.gradient + row_offset + x;
    const std::uint8_t* normal_at = maps.normal + row_offset + x;
    for (int i = 0; i < count;) {
      const int end = i + kFeaturesPerByteSum < count ? i + kFeaturesPerByteSum : count;
      auto gradient_bytes = hn::Zero(d8), normal_bytes = hn::Zero(d8);
      for (; i < end; ++i) {
        const ScanFeature& f = features[i];
        const auto g = hn::LoadU(d8, gradient_at + f.offset);
        const auto n = hn::LoadU(d8, normal_at + f.offset);
        const auto g_miss =
            hn::VecFromMask(d8, hn::Eq(hn::And(g, hn::Set(d8, f.gradient_bits)), hn::Zero(d8)));
        const auto n_miss =
            hn::VecFromMask(d8, hn::Eq(hn::And(n, hn::Set(d8, f.normal_bits)), hn::Zero(d8)));
        gradient_bytes =
            hn::Add(gradient_bytes, hn::AndNot(g_miss, hn::Set(d8, f.gradient_weight)));
        normal_bytes = hn::Add(normal_bytes, hn::AndNot(n_miss, hn::Set(d8, f.normal_weight)));
      }
      gradient_low =
          hn::Add(gradient_low, hn::PromoteTo(d16, hn::LowerHalf(half8, gradient_bytes)));
      gradient_high =
          hn::Add(gradient_high, hn::PromoteTo(d16, hn::UpperHalf(half8, gradient_bytes)));
      normal_low = hn::Add(normal_low, hn::PromoteTo(d16, hn::LowerHalf(half8, normal_bytes)));
      normal_high = hn::Add(normal_high, hn::PromoteTo(d16, hn::UpperHalf(half8, normal_bytes)));
    }
    hn::StoreU(gradient_low, d16, gradient_sums + x);
    hn::StoreU(gradient_high, d16, gradient_sums + x + half);
    hn::StoreU(normal_low, d16, normal_sums + x);
    hn::StoreU(normal_high, d16, normal_sums + x + half);
  }
}

// Adds up a template's matches over 16 gradient and 16 normal bytes per feature. `load_block` gives
// the 16 bytes of one modality; registers hold one modality each where they are 16 bytes wide.
template <class LoadGradient, class LoadNormal>
HWY_INLINE void SumBlocks(const Feature* features, int count, const LoadGradient& load_gradient,
                          const LoadNormal& load_normal, BlockSums& out) {
  const hn::FixedTag<std::uint8_t, 16> d8;
  const hn::FixedTag<std::uint16_t, 8> d16;
  const hn::FixedTag<std::uint8_t, 8> half8;
  auto gradient_low = hn::Zero(d16), gradient_high = hn::Zero(d16);
  auto normal_low = hn::Zero(d16), normal_high = hn::Zero(d16);
  for (int i = 0; i < count;) {
    const int end = i + kFeaturesPerByteSum < count ? i + kFeaturesPerByteSum : count;
    auto gradient_bytes = hn::Zero(d8), normal_bytes = hn::Zero(d8);
    for (; i < end; ++i) {
      const Feature& f = features[i];
      const auto g_miss = hn::VecFromMask(
          d8, hn::Eq(hn::And(load_gradient(f), hn::Set(d8, f.gradient_bits)), hn::Zero(d8)));
      const auto n_miss = hn::VecFromMask(
          d8, hn::Eq(hn::And(load_normal(f), hn::Set(d8, f.normal_bits)), hn::Zero(d8)));
      gradient_bytes = hn::Add(gradient_bytes, hn::AndNot(g_miss, hn::Set(d8, f.gradient_weight)));
      normal_bytes = hn::Add(normal_bytes, hn::AndNot(n_miss, hn::Set(d8, f.normal_weight)));
    }
    gradient_low = hn::Add(gradient_low, hn::PromoteTo(d16, hn::LowerHalf(half8, gradient_bytes)));
    gradient_high =
        hn::Add(gradient_high, hn::PromoteTo(d16, hn::UpperHalf(half8, gradient_bytes)));
    normal_low = hn::Add(normal_low, hn::PromoteTo(d16, hn::LowerHalf(half8, normal_bytes)));
    normal_high = hn::Add(normal_high, hn::PromoteTo(d16, hn::UpperHalf(half8, normal_bytes)));
  }
  hn::StoreU(gradient_low, d16, out.gradient);
  hn::StoreU(gradient_high, d16, out.gradient + 8);
  hn::StoreU(normal_low, d16, out.normal);
  hn::StoreU(normal_high, d16, out.normal + 8);
}

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
// 256-bit registers: one load, one comparison and one sum for both modalities of a block.
void MatchBlockRearranged(const RearrangedMap& map, int x, int y, const Feature* features,
                          int count, int scale_q8, BlockSums& out) {
  const hn::FixedTag<std::uint8_t, 32> d8;
  const hn::FixedTag<std::uint16_t, 16> d16;
  const hn::FixedTag<std::uint8_t, 16> half8;
  // A feature's four last bytes are gradient bits and weight, normal bits and weight: one
  // broadcast, and two patterns that spread them over the gradient half and the normal half.
  const hn::Repartition<std::uint32_t, decltype(d8)> d32;
  alignas(32) static constexpr std::uint8_t kBits[32] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                                         0, 0, 0, 0, 0, 2, 2, 2, 2, 2, 2,
                                                         2, 2, 2, 2, 2, 2, 2, 2, 2, 2};
  alignas(32) static constexpr std::uint8_t kWeights[32] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,
                                                            1, 1, 1, 1, 1, 3, 3, 3, 3, 3, 3,
                                                            3, 3, 3, 3, 3, 3, 3, 3, 3, 3};
  const auto spread_bits = hn::Load(d8, kBits), spread_weights = hn::Load(d8, kWeights);
  const std::uint8_t* origin = map.blocks + (y / 2 * map.stride_blocks + x / 2) * kBlockBytes;
  auto gradient = hn::Zero(d16), normal = hn::Zero(d16);
  for (int i = 0; i < count;) {
    const int end = i + kFeaturesPerByteSum < count ? i + kFeaturesPerByteSum : count;
    auto bytes = hn::Zero(d8);
    for (; i < end; ++i) {
      const Feature& f = features[i];
      const auto block =
          hn::LoadU(d8, origin + (scaled_half_offset(f.y, scale_q8) * map.stride_blocks +
                                  scaled_half_offset(f.x, scale_q8)) *
                                     kBlockBytes);
      std::uint32_t packed;
      __builtin_memcpy(&packed, &f.gradient_bits, sizeof(packed));
      const auto all = hn::BitCast(d8, hn::Set(d32, packed));
      const auto bits = hn::TableLookupBytes(all, spread_bits);
      const auto weights = hn::TableLookupBytes(all, spread_weights);
      const auto miss = hn::VecFromMask(d8, hn::Eq(hn::And(block, bits), hn::Zero(d8)));
      bytes = hn::Add(bytes, hn::AndNot(miss, weights));
    }
    gradient = hn::Add(gradient, hn::PromoteTo(d16, hn::LowerHalf(half8, bytes)));
    normal = hn::Add(normal, hn::PromoteTo(d16, hn::UpperHalf(half8, bytes)));
  }
  hn::Store(gradient, d16, out.gradient);
  hn::Store(normal, d16, out.normal);
}
#else
void MatchBlockRearranged(const RearrangedMap& map, int x, int y, const Feature* features,
                          int count, int scale_q8, BlockSums& out) {
  const hn::FixedTag<std::uint8_t, 16> d8;
  const std::uint8_t* origin = map.blocks + (y / 2 * map.stride_blocks + x / 2) * kBlockBytes;
  auto block_of = [&](const Feature& f) {
    return origin + (scaled_half_offset(f.y, scale_q8) * map.stride_blocks +
                     scaled_half_offset(f.x, scale_q8)) *
                        kBlockBytes;
  };
  SumBlocks(
      features, count, [&](const Feature& f) { return hn::LoadU(d8, block_of(f)); },
      [&](const Feature& f) { return hn::LoadU(d8, block_of(f) + 16); }, out);
}
#endif

// Without rearrangement four short rows have to be collected for each modality.
void MatchBlockPlain(const PlainMaps& maps, int x, int y, const Feature* features, int count,
                     int scale_q8, BlockSums& out) {
  const hn::FixedTag<std::uint8_t, 16> d8;
  auto gather = [&](const std::uint8_t* base, const Feature& f) {
    const std::uint8_t* at = base + (y + 2 * scaled_half_offset(f.y, scale_q8)) * maps.stride + x +
                             2 * scaled_half_offset(f.x, scale_q8);
    alignas(16) std::uint8_t block[16];
    for (int r = 0; r < 4; ++r) __builtin_memcpy(block + 4 * r, at + r * maps.stride, 4);
    return hn::Load(d8, block);
  };
  SumBlocks(
      features, count, [&](const Feature& f) { return gather(maps.gradient, f); },
      [&](const Feature& f) { return gather(maps.normal, f); }, out);
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(ScanRow);
HWY_EXPORT(MatchBlockRearranged);
HWY_EXPORT(MatchBlockPlain);

SearchKernels search_kernels_vector(std::size_t target_index) {
  return {HWY_DISPATCH_TABLE(ScanRow)[target_index],
          HWY_DISPATCH_TABLE(MatchBlockRearranged)[target_index],
          HWY_DISPATCH_TABLE(MatchBlockPlain)[target_index]};
}

}  // namespace binpick::simd
#endif
