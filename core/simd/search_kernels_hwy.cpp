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

void PlaceFeatures(const Feature* features, int count, int scale_q8, MapSteps steps,
                   PlacedFeature* out) {
  search_kernels_scalar().place_features(features, count, scale_q8, steps, out);
}
int ScanCells(const PlainMaps& maps, std::ptrdiff_t row_offset, int cells, const PlacedTemplate& t,
              const std::uint16_t* known, CellScore* better) {
  return search_kernels_scalar().scan_cells(maps, row_offset, cells, t, known, better);
}
void MatchBlocksRearranged(const RearrangedMap& map, const std::ptrdiff_t* places, int count,
                           const PlacedTemplate& t, BlockScores* out) {
  search_kernels_scalar().match_blocks_rearranged(map, places, count, t, out);
}
void MatchBlocksPlain(const PlainMaps& maps, const std::ptrdiff_t* places, int count,
                      const PlacedTemplate& t, BlockScores* out) {
  search_kernels_scalar().match_blocks_plain(maps, places, count, t, out);
}

#else

// Byte sums of weights up to 31 stay below 256 for this many features; then they are widened.
constexpr int kFeaturesPerByteSum = 8;

// Adds the weight where the map meets the bits.
template <class V>
HWY_INLINE V AddMatches(V sum, V map, V bits, V weight) {
#if HWY_TARGET <= HWY_AVX3  // vptestm, which TestBit is here, asks for any of the bits
  return hn::IfThenElse(hn::TestBit(map, bits), hn::Add(sum, weight), sum);
#else
  const hn::DFromV<V> d8;
  const auto missed = hn::VecFromMask(d8, hn::Eq(hn::And(map, bits), hn::Zero(d8)));
  return hn::Add(sum, hn::AndNot(missed, weight));
#endif
}

// Byte sums are widened apart: those of pixels with even x, and those with odd x.
template <class V8, class V16>
HWY_INLINE void AddBytes(V8 bytes, V16& even, V16& odd) {
  const hn::DFromV<V16> d16;
  const auto pairs = hn::BitCast(d16, bytes);
  even = hn::Add(even, hn::And(pairs, hn::Set(d16, 0xFF)));
  odd = hn::Add(odd, hn::ShiftRight<8>(pairs));
}

// ScoreScale::score in lanes of 16 bits: with each factor split into halves, score = sums * high
// halves + upper halves of sums * low halves + the carry of what is below.
template <class D16>
class Scorer {
 public:
  HWY_INLINE Scorer(D16 d16, const ScoreScale& scale)
      : gradient_high_(hn::Set(d16, static_cast<std::uint16_t>(scale.gradient >> 16))),
        gradient_low_(hn::Set(d16, static_cast<std::uint16_t>(scale.gradient))),
        normal_high_(hn::Set(d16, static_cast<std::uint16_t>(scale.normal >> 16))),
        normal_low_(hn::Set(d16, static_cast<std::uint16_t>(scale.normal))) {}

  template <class V>
  HWY_INLINE V operator()(V gradient, V normal) const {
    const D16 d16;
    const V below_gradient = hn::Mul(gradient, gradient_low_);
    const V below_normal = hn::Mul(normal, normal_low_);
    const V minus_one_without_carry =
        hn::VecFromMask(d16, hn::Eq(hn::Add(below_gradient, below_normal),
                                    hn::SaturatedAdd(below_gradient, below_normal)));
    const V carry = hn::Add(hn::Set(d16, 1), minus_one_without_carry);
    const V upper = hn::Add(hn::MulHigh(gradient, gradient_low_), hn::MulHigh(normal, normal_low_));
    const V whole = hn::Add(hn::Mul(gradient, gradient_high_), hn::Mul(normal, normal_high_));
    return hn::Add(hn::Add(whole, upper), carry);
  }

 private:
  hn::Vec<D16> gradient_high_, gradient_low_, normal_high_, normal_low_;
};

void PlaceFeatures(const Feature* features, int count, int scale_q8, MapSteps steps,
                   PlacedFeature* out) {
  static_assert(sizeof(Feature) == 6 && sizeof(PlacedFeature) == 8);
  const hn::FixedTag<std::uint8_t, 16> d8;
  const hn::Repartition<std::int32_t, decltype(d8)> d32;
  const hn::Repartition<std::uint64_t, decltype(d8)> d64;
  // Of two features: each x and y to the top of 32 bits; bits and weights to the upper half of 64.
  alignas(16) static constexpr std::uint8_t kOffsets[16] = {
      0x80, 0x80, 0x80, 0, 0x80, 0x80, 0x80, 1, 0x80, 0x80, 0x80, 6, 0x80, 0x80, 0x80, 7};
  alignas(16) static constexpr std::uint8_t kRest[16] = {0x80, 0x80, 0x80, 0x80, 2, 3, 4,  5,
                                                         0x80, 0x80, 0x80, 0x80, 8, 9, 10, 11};
  const auto to_offsets = hn::Load(d8, kOffsets), to_rest = hn::Load(d8, kRest);
  const auto scale = hn::Set(d32, scale_q8), half = hn::Set(d32, 256);
  const auto step = hn::BitCast(d32, hn::Set(d64, static_cast<std::uint64_t>(steps.y) << 32 |
                                                      static_cast<std::uint32_t>(steps.x)));
  const auto lower = hn::Set(d64, 0xFFFFFFFF);
  int i = 0;
  for (; i + 2 < count; i += 2) {  // 16 bytes reach into a third feature
    const auto two = hn::LoadU(d8, reinterpret_cast<const std::uint8_t*>(features + i));
    const auto xy = hn::ShiftRight<24>(hn::BitCast(d32, hn::TableLookupBytesOr0(two, to_offsets)));
    const auto halves = hn::ShiftRight<9>(hn::Add(hn::Mul(xy, scale), half));
    const auto parts = hn::BitCast(d64, hn::Mul(halves, step));
    const auto offsets = hn::BitCast(
        d64, hn::Add(hn::BitCast(d32, parts), hn::BitCast(d32, hn::ShiftRight<32>(parts))));
    const auto placed =
        hn::Or(hn::And(offsets, lower), hn::BitCast(d64, hn::TableLookupBytesOr0(two, to_rest)));
    hn::StoreU(hn::BitCast(d8, placed), d8, reinterpret_cast<std::uint8_t*>(out + i));
  }
  search_kernels_scalar().place_features(features + i, count - i, scale_q8, steps, out + i);
}

using DRow8 = hn::CappedTag<std::uint8_t, 64>;
using DRow16 = hn::Repartition<std::uint16_t, DRow8>;
using VRow16 = hn::Vec<DRow16>;
// The pixels of a register's cells: upper row even x, odd x, lower row even x, odd x.
struct CellPixels {
  VRow16 pixel[4];
};

// Sums of one modality at the cells of kRegisters registers: each feature is spread once for all.
template <auto kBits, auto kWeight, int kRegisters>
HWY_INLINE void SumCells(const std::uint8_t* upper, std::ptrdiff_t stride,
                         const PlacedFeature* features, int count, CellPixels (&sums)[kRegisters]) {
  const DRow8 d8;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d8));
  for (CellPixels& s : sums) {
    for (VRow16& pixel : s.pixel) pixel = hn::Zero(DRow16());
  }
  for (int i = 0; i < count;) {
    const int end = i + kFeaturesPerByteSum < count ? i + kFeaturesPerByteSum : count;
    hn::Vec<DRow8> bytes[kRegisters][2];
    for (auto& rows : bytes) rows[0] = rows[1] = hn::Zero(d8);
    for (; i < end; ++i) {
      const std::uint8_t* at = upper + features[i].offset;
      const auto bits = hn::Set(d8, features[i].*kBits);
      const auto weight = hn::Set(d8, features[i].*kWeight);
      for (int r = 0; r < kRegisters; ++r) {
        const auto above = hn::LoadU(d8, at + r * lanes);
        const auto below = hn::LoadU(d8, at + stride + r * lanes);
        bytes[r][0] = AddMatches(bytes[r][0], above, bits, weight);
        bytes[r][1] = AddMatches(bytes[r][1], below, bits, weight);
      }
    }
    for (int r = 0; r < kRegisters; ++r) {
      AddBytes(bytes[r][0], sums[r].pixel[0], sums[r].pixel[1]);
      AddBytes(bytes[r][1], sums[r].pixel[2], sums[r].pixel[3]);
    }
  }
}

// Appends those of the `cells` cells of a register, the first of them `first`, that are better than
// known.
HWY_INLINE CellScore* AppendBetter(const CellPixels& of, VRow16 known, int first, int cells,
                                   CellScore* better) {
  const DRow16 d16;
  const VRow16 best = hn::Max(hn::Max(of.pixel[0], of.pixel[1]), hn::Max(of.pixel[2], of.pixel[3]));
  const auto improved =
      hn::And(hn::Gt(best, known), hn::FirstN(d16, static_cast<std::size_t>(cells)));
  if (hn::AllFalse(d16, improved)) return better;
  alignas(64) std::uint16_t scores[4][32];
  for (int p = 0; p < 4; ++p) hn::Store(of.pixel[p], d16, scores[p]);
  std::uint64_t bits = 0;
  hn::StoreMaskBits(d16, improved, reinterpret_cast<std::uint8_t*>(&bits));
  for (; bits != 0; bits &= bits - 1) {
    const int k = static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    int pixel = 0;
    for (int p = 1; p < 4; ++p) pixel = scores[p][k] > scores[pixel][k] ? p : pixel;
    *better++ = {static_cast<std::uint16_t>(first + k), scores[pixel][k],
                 static_cast<std::uint8_t>(pixel)};
  }
  return better;
}

template <int kRegisters>
HWY_INLINE CellScore* ScanSome(const PlainMaps& maps, std::ptrdiff_t row_offset, int first,
                               int cells, const PlacedTemplate& t, const std::uint16_t* known,
                               CellScore* better) {
  const DRow16 d16;
  const std::ptrdiff_t at = row_offset + 2 * first;
  CellPixels gradient[kRegisters], normal[kRegisters];
  SumCells<&PlacedFeature::gradient_bits, &PlacedFeature::gradient_weight>(
      maps.gradient + at, maps.stride, t.features, t.with_gradient, gradient);
  SumCells<&PlacedFeature::normal_bits, &PlacedFeature::normal_weight>(
      maps.normal + at, maps.stride, t.features, t.count, normal);
  const Scorer<DRow16> score(d16, t.scale);
  for (int r = 0; r < kRegisters; ++r) {
    CellPixels scores;
    for (int p = 0; p < 4; ++p) scores.pixel[p] = score(gradient[r].pixel[p], normal[r].pixel[p]);
    const int lanes = static_cast<int>(hn::Lanes(d16)), c = first + r * lanes;
    better = AppendBetter(scores, hn::LoadU(d16, known + c), c,
                          cells - c < lanes ? cells - c : lanes, better);
  }
  return better;
}

int ScanCells(const PlainMaps& maps, std::ptrdiff_t row_offset, int cells, const PlacedTemplate& t,
              const std::uint16_t* known, CellScore* better) {
  const int lanes = static_cast<int>(hn::Lanes(DRow16()));
  CellScore* end = better;
  int c = 0;
  for (; c + lanes < cells; c += 2 * lanes)
    end = ScanSome<2>(maps, row_offset, c, cells, t, known, end);
  if (c < cells) end = ScanSome<1>(maps, row_offset, c, cells, t, known, end);
  return static_cast<int>(end - better);
}

// A block of 16 gradient and 16 normal bytes, in one register or in two; V: of 8 or 16 bits.
#if HWY_MAX_BYTES >= 32
constexpr int kRegisters = 1;
#else
constexpr int kRegisters = 2;
#endif
using DBlock8 = hn::FixedTag<std::uint8_t, 32 / kRegisters>;
using DBlock16 = hn::Repartition<std::uint16_t, DBlock8>;
using DModality16 = hn::FixedTag<std::uint16_t, 8>;
template <class D>
struct Block {
  hn::Vec<D> part[kRegisters];
};
#if HWY_MAX_BYTES >= 32
HWY_INLINE hn::Vec<DModality16> GradientOf(const Block<DBlock16>& b) {
  return hn::LowerHalf(DModality16(), b.part[0]);
}
HWY_INLINE hn::Vec<DModality16> NormalOf(const Block<DBlock16>& b) {
  return hn::UpperHalf(DModality16(), b.part[0]);
}
#else
HWY_INLINE hn::Vec<DModality16> GradientOf(const Block<DBlock16>& b) {
  return b.part[0];
}
HWY_INLINE hn::Vec<DModality16> NormalOf(const Block<DBlock16>& b) {
  return b.part[1];
}
#endif

struct RearrangedBlocks {
  const std::uint8_t* blocks;

  HWY_INLINE Block<DBlock8> at(std::ptrdiff_t place) const {
    Block<DBlock8> b;
    for (int r = 0; r < kRegisters; ++r) b.part[r] = hn::Load(DBlock8(), blocks + place + 16 * r);
    return b;
  }
};

// Without rearrangement four short rows have to be collected for each modality.
struct PlainBlocks {
  const PlainMaps& maps;

  HWY_INLINE hn::Vec<hn::FixedTag<std::uint8_t, 16> > rows(const std::uint8_t* at) const {
    const hn::FixedTag<std::uint8_t, 16> d8;
    const hn::Repartition<std::uint32_t, decltype(d8)> d32;
    const hn::Repartition<std::uint64_t, decltype(d8)> d64;
    const auto row = [&](int r) HWY_ATTR {
      std::uint32_t four;
      __builtin_memcpy(&four, at + r * maps.stride, sizeof(four));
      return hn::Set(d32, four);
    };
    const auto upper = hn::InterleaveLower(d32, row(0), row(1));
    const auto lower = hn::InterleaveLower(d32, row(2), row(3));
    return hn::BitCast(d8,
                       hn::InterleaveLower(d64, hn::BitCast(d64, upper), hn::BitCast(d64, lower)));
  }
  HWY_INLINE Block<DBlock8> at(std::ptrdiff_t place) const {
    const auto gradient = rows(maps.gradient + place), normal = rows(maps.normal + place);
#if HWY_MAX_BYTES >= 32
    return {{hn::Combine(DBlock8(), normal, gradient)}};
#else
    return {{gradient, normal}};
#endif
  }
};

// Scores at the even and at the odd pixels of four rows of four.
HWY_INLINE void StoreScores(hn::Vec<DModality16> even, hn::Vec<DModality16> odd, BlockScores& out) {
  const DModality16 d16;
  const hn::Repartition<std::uint32_t, DModality16> d32;
  hn::StoreU(hn::InterleaveLower(d16, even, odd), d16, out.pixels);
  hn::StoreU(hn::InterleaveUpper(d16, even, odd), d16, out.pixels + 8);
  // 32 bits hold a row of two quads.
  const auto row = hn::BitCast(d32, hn::Max(even, odd));
  const auto best =
      hn::BitCast(d32, hn::Max(hn::BitCast(d16, row), hn::BitCast(d16, hn::Shuffle2301(row))));
  const hn::Half<DModality16> half16;
  hn::StoreU(hn::LowerHalf(half16, hn::BitCast(d16, hn::ConcatEven(d32, best, best))), half16,
             out.best);
}

// Each feature is spread over a block's registers once, for all of kBlocks places.
template <int kBlocks, class Map>
HWY_INLINE void MatchSome(const Map& map, const std::ptrdiff_t* places, const PlacedTemplate& t,
                          BlockScores* out) {
  const DBlock8 d8;
  const DBlock16 d16;
  const hn::Repartition<std::uint32_t, DBlock8> d32;
  // A feature's four last bytes are gradient bits and weight, normal bits and weight.
  alignas(32) static constexpr std::uint8_t kBits[32] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                                         0, 0, 0, 0, 0, 2, 2, 2, 2, 2, 2,
                                                         2, 2, 2, 2, 2, 2, 2, 2, 2, 2};
  alignas(32) static constexpr std::uint8_t kWeights[32] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,
                                                            1, 1, 1, 1, 1, 3, 3, 3, 3, 3, 3,
                                                            3, 3, 3, 3, 3, 3, 3, 3, 3, 3};
  Block<DBlock16> even[kBlocks], odd[kBlocks];
  for (int b = 0; b < kBlocks; ++b) {
    for (int r = 0; r < kRegisters; ++r) even[b].part[r] = odd[b].part[r] = hn::Zero(d16);
  }
  for (int i = 0; i < t.count;) {
    const int end = i + kFeaturesPerByteSum < t.count ? i + kFeaturesPerByteSum : t.count;
    Block<DBlock8> sums[kBlocks];
    for (int b = 0; b < kBlocks; ++b) {
      for (int r = 0; r < kRegisters; ++r) sums[b].part[r] = hn::Zero(d8);
    }
    for (; i < end; ++i) {
      const PlacedFeature& f = t.features[i];
      std::uint32_t packed;
      __builtin_memcpy(&packed, &f.gradient_bits, sizeof(packed));
      const auto all = hn::BitCast(d8, hn::Set(d32, packed));
      hn::Vec<DBlock8> bits[kRegisters], weights[kRegisters];
      for (int r = 0; r < kRegisters; ++r) {
        bits[r] = hn::TableLookupBytes(all, hn::Load(d8, kBits + 16 * r));
        weights[r] = hn::TableLookupBytes(all, hn::Load(d8, kWeights + 16 * r));
      }
      for (int b = 0; b < kBlocks; ++b) {
        const Block<DBlock8> block = map.at(places[b] + f.offset);
        for (int r = 0; r < kRegisters; ++r)
          sums[b].part[r] = AddMatches(sums[b].part[r], block.part[r], bits[r], weights[r]);
      }
    }
    for (int b = 0; b < kBlocks; ++b) {
      for (int r = 0; r < kRegisters; ++r)
        AddBytes(sums[b].part[r], even[b].part[r], odd[b].part[r]);
    }
  }
  const Scorer<DModality16> score(DModality16(), t.scale);
  for (int b = 0; b < kBlocks; ++b) {
    StoreScores(score(GradientOf(even[b]), NormalOf(even[b])),
                score(GradientOf(odd[b]), NormalOf(odd[b])), out[b]);
  }
}

template <class Map>
HWY_INLINE void MatchBlocks(const Map& map, const std::ptrdiff_t* places, int count,
                            const PlacedTemplate& t, BlockScores* out) {
  int i = 0;
  for (; i + 4 <= count; i += 4) MatchSome<4>(map, places + i, t, out + i);
  if (count - i >= 2) {
    MatchSome<2>(map, places + i, t, out + i);
    i += 2;
  }
  if (i < count) MatchSome<1>(map, places + i, t, out + i);
}

void MatchBlocksRearranged(const RearrangedMap& map, const std::ptrdiff_t* places, int count,
                           const PlacedTemplate& t, BlockScores* out) {
  MatchBlocks(RearrangedBlocks{map.blocks}, places, count, t, out);
}
void MatchBlocksPlain(const PlainMaps& maps, const std::ptrdiff_t* places, int count,
                      const PlacedTemplate& t, BlockScores* out) {
  MatchBlocks(PlainBlocks{maps}, places, count, t, out);
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(PlaceFeatures);
HWY_EXPORT(ScanCells);
HWY_EXPORT(MatchBlocksRearranged);
HWY_EXPORT(MatchBlocksPlain);

SearchKernels search_kernels_vector(std::size_t target_index) {
  return {HWY_DISPATCH_TABLE(PlaceFeatures)[target_index],
          HWY_DISPATCH_TABLE(ScanCells)[target_index],
          HWY_DISPATCH_TABLE(MatchBlocksRearranged)[target_index],
          HWY_DISPATCH_TABLE(MatchBlocksPlain)[target_index]};
}

}  // namespace binpick::simd
#endif
