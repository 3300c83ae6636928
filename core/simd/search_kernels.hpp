// The integer kernels of the search (paper section III-C). Each exists as a scalar function, which
// is the specification and ships, and as one Highway source compiled for every vector unit; all
// give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "binpick/model/object_model.hpp"

namespace binpick::simd {

// One feature of a template that is scanned exhaustively: offset in elements of the plain maps
// (both have the same stride).
struct ScanFeature {
  std::int32_t offset;
  std::uint8_t gradient_bits, gradient_weight;
  std::uint8_t normal_bits, normal_weight;
};

// Both orientation maps of one pyramid level, one byte a pixel, bit b set where the orientation
// falls into bin b. Around the image lies a border of zeros wide enough for every template.
struct PlainMaps {
  const std::uint8_t* gradient;  // pixel (0, 0)
  const std::uint8_t* normal;
  std::ptrdiff_t stride;
};

// The same, rearranged (paper section III-C): for each second pixel in x and y the 4x4 pixels from
// there, row by row, 16 gradient bytes and then 16 normal bytes: 32 consecutive bytes.
inline constexpr std::ptrdiff_t kBlockBytes = 32;
struct RearrangedMap {
  const std::uint8_t* blocks;    // block of pixel (0, 0); 32-byte aligned
  std::ptrdiff_t stride_blocks;  // blocks from one even row to the next
};

// Weighted matches of both modalities at the 16 pixels of a 4x4 block, row by row.
struct BlockSums {
  alignas(32) std::uint16_t gradient[16];
  alignas(32) std::uint16_t normal[16];
};

// Elements beyond a row that a kernel may read, or write into a buffer of sums: one register's
// width.
inline constexpr std::ptrdiff_t kReadAhead = 64;

// Template offsets at another distance: half-offset = (offset * scale + 256) >> 9, scale in 1/256;
// the pixel offset is twice that, so always even.
inline int scaled_half_offset(int offset, int scale_q8) {
  return (offset * scale_q8 + 256) >> 9;
}

// Sums of equal weights at x = 0 .. width-1 of one image row:
//   gradient_sums[x] = sum of gradient_weight over the features whose bits meet maps.gradient[row +
//   x + offset],
// and likewise for normals. `row_offset`: element of (0, y). Reads up to 63 elements beyond the
// last x; writes up to 63 sums beyond it (the buffers are padded). At most 255 features with
// weights up to 31.
using ScanRowFn = void (*)(const PlainMaps& maps, std::ptrdiff_t row_offset, int width,
                           const ScanFeature* features, int count, std::uint16_t* gradient_sums,
                           std::uint16_t* normal_sums);

// The same sums at the 4x4 pixels whose first is (x, y), both even. Features have even offsets.
using MatchBlockRearrangedFn = void (*)(const RearrangedMap& map, int x, int y,
                                        const Feature* features, int count, int scale_q8,
                                        BlockSums& out);
using MatchBlockPlainFn = void (*)(const PlainMaps& maps, int x, int y, const Feature* features,
                                   int count, int scale_q8, BlockSums& out);

struct SearchKernels {
  ScanRowFn scan_row;
  MatchBlockRearrangedFn match_block_rearranged;
  MatchBlockPlainFn match_block_plain;
};

// The specification.
SearchKernels search_kernels_scalar();
// Compiled for one vector unit; `target_index`: position in Highway's dispatch tables.
SearchKernels search_kernels_vector(std::size_t target_index);

}  // namespace binpick::simd
