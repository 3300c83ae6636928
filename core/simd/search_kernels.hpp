// The integer kernels of the search (paper section III-C). Each exists as a scalar function, which
// is the specification and ships, and as one Highway source compiled for every vector unit; all
// give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "binpick/model/object_model.hpp"
#include "simd/score_scale.hpp"

namespace binpick::simd {

// Two pixels to the right and two pixels down, in elements of a map.
struct MapSteps {
  std::ptrdiff_t x, y;
};

// Both orientation maps of one pyramid level, one byte a pixel, bit b set where the orientation
// falls into bin b. Around the image lies a border of zeros wide enough for every template.
struct PlainMaps {
  const std::uint8_t* gradient;  // pixel (0, 0)
  const std::uint8_t* normal;
  std::ptrdiff_t stride;

  MapSteps steps() const { return {2, 2 * stride}; }
};

// The same, rearranged (paper section III-C): for each second pixel in x and y the 4x4 pixels from
// there, row by row, 16 gradient bytes and then 16 normal bytes: 32 consecutive bytes.
inline constexpr std::ptrdiff_t kBlockBytes = 32;
struct RearrangedMap {
  const std::uint8_t* blocks;    // block of pixel (0, 0); 32-byte aligned
  std::ptrdiff_t stride_blocks;  // blocks from one even row to the next

  MapSteps steps() const { return {kBlockBytes, stride_blocks * kBlockBytes}; }
};

// Bytes of a plain map that a kernel may read beyond a row, and elements of `known` that it may
// read beyond the last cell: one register's width.
inline constexpr std::ptrdiff_t kReadAhead = 64;

inline constexpr int kTemplateFeaturesMax = 255;

// A feature of a template at one scale and on one map.
struct PlacedFeature {
  std::int32_t offset;  // elements of the map, from the place at which the template is matched
  std::uint8_t gradient_bits, gradient_weight;
  std::uint8_t normal_bits, normal_weight;
};

// At most kTemplateFeaturesMax features with weights up to kFeatureWeightMax. Those from
// `with_gradient` on have no gradient bits: nothing need look for them.
struct PlacedTemplate {
  const PlacedFeature* features;
  int count, with_gradient;
  ScoreScale scale;
};

// Template offsets at another distance: half-offset = (offset * scale + 256) >> 9, scale in 1/256;
// the pixel offset is twice that, so always even.
inline int scaled_half_offset(int offset, int scale_q8) {
  return (offset * scale_q8 + 256) >> 9;
}

// Places `count` features at scaled_half_offset() times the steps. 0 <= scale_q8 < 2^15; steps and
// offsets fit 32 bits.
using PlaceFeaturesFn = void (*)(const Feature* features, int count, int scale_q8, MapSteps steps,
                                 PlacedFeature* out);

// A cell of 2x2 pixels, its best score and the first pixel, row by row, that has it.
struct CellScore {
  std::uint16_t cell, score;
  std::uint8_t pixel;
};

// Scores a template at every pixel of two image rows: ScoreScale::score of the weights of the
// features whose bits meet the maps' at the pixel plus the feature's offset. Cell c covers x = 2c
// and 2c + 1 of both rows. Writes the cells whose best score is above known[c], in order, to
// `better` (room for `cells`), and returns how many. `row_offset`: element of (0, y) of the upper
// row. Reads up to 63 elements of the maps, and of `known`, beyond the last cell's.
using ScanCellsFn = int (*)(const PlainMaps& maps, std::ptrdiff_t row_offset, int cells,
                            const PlacedTemplate& t, const std::uint16_t* known, CellScore* better);

// Scores at the 16 pixels of a 4x4 block, row by row, and the best of each of its 2x2 quads.
struct BlockScores {
  std::uint16_t pixels[16];
  std::uint16_t best[4];
};

// Scores a template at `count` blocks; places[i] is the element of the first pixel of block i. Of a
// rearranged map places and offsets are multiples of kBlockBytes.
using MatchBlocksRearrangedFn = void (*)(const RearrangedMap& map, const std::ptrdiff_t* places,
                                         int count, const PlacedTemplate& t, BlockScores* out);
using MatchBlocksPlainFn = void (*)(const PlainMaps& maps, const std::ptrdiff_t* places, int count,
                                    const PlacedTemplate& t, BlockScores* out);

struct SearchKernels {
  PlaceFeaturesFn place_features;
  ScanCellsFn scan_cells;
  MatchBlocksRearrangedFn match_blocks_rearranged;
  MatchBlocksPlainFn match_blocks_plain;
};

// The specification.
SearchKernels search_kernels_scalar();
// Compiled for one vector unit; `target_index`: position in Highway's dispatch tables.
SearchKernels search_kernels_vector(std::size_t target_index);

}  // namespace binpick::simd
