#include <algorithm>

#include "simd/search_kernels.hpp"

namespace binpick::simd {
namespace {

void place_features(const Feature* features, int count, int scale_q8, MapSteps steps,
                    PlacedFeature* out) {
  for (int i = 0; i < count; ++i) {
    const Feature& f = features[i];
    const std::ptrdiff_t offset =
        scaled_half_offset(f.x, scale_q8) * steps.x + scaled_half_offset(f.y, scale_q8) * steps.y;
    out[i] = {static_cast<std::int32_t>(offset), f.gradient_bits, f.gradient_weight, f.normal_bits,
              f.normal_weight};
  }
}

// Adds the weight at the pixels of a row where the map meets the bits.
void add_matches(const std::uint8_t* map, int width, std::uint8_t bits, std::uint8_t weight,
                 std::uint16_t* sums) {
  for (int x = 0; x < width; ++x) {
    const int matched = ((map[x] & bits) != 0) * weight;  // no branch: compilers vectorise it
    sums[x] = static_cast<std::uint16_t>(sums[x] + matched);
  }
}

int scan_cells(const PlainMaps& maps, std::ptrdiff_t row_offset, int cells, const PlacedTemplate& t,
               const std::uint16_t* known, CellScore* better) {
  constexpr int kCellsAtOnce = 32;
  int found = 0;
  for (int first = 0; first < cells; first += kCellsAtOnce) {
    const int count = std::min(cells - first, kCellsAtOnce);
    std::uint16_t gradient[2][2 * kCellsAtOnce] = {}, normal[2][2 * kCellsAtOnce] = {};
    for (int i = 0; i < t.count; ++i) {
      const PlacedFeature& f = t.features[i];
      for (int row = 0; row < 2; ++row) {
        const std::ptrdiff_t at = row_offset + row * maps.stride + 2 * first + f.offset;
        add_matches(maps.gradient + at, 2 * count, f.gradient_bits, f.gradient_weight,
                    gradient[row]);
        add_matches(maps.normal + at, 2 * count, f.normal_bits, f.normal_weight, normal[row]);
      }
    }
    for (int c = 0; c < count; ++c) {
      CellScore cell{static_cast<std::uint16_t>(first + c), known[first + c], 0};
      for (int p = 0; p < 4; ++p) {
        const int x = 2 * c + p % 2;
        const std::uint16_t score = t.scale.score(gradient[p / 2][x], normal[p / 2][x]);
        if (score <= cell.score) continue;
        cell.score = score;
        cell.pixel = static_cast<std::uint8_t>(p);
      }
      if (cell.score > known[first + c]) better[found++] = cell;
    }
  }
  return found;
}

// `row_of(at, r)`: the four gradient and four normal bytes of row r of the block at `at`.
struct BlockRow {
  const std::uint8_t *gradient, *normal;
};
template <class RowOf>
void match_blocks(const std::ptrdiff_t* places, int count, const PlacedTemplate& t,
                  BlockScores* out, RowOf&& row_of) {
  for (int b = 0; b < count; ++b) {
    std::uint16_t gradient[16] = {}, normal[16] = {};
    for (int i = 0; i < t.count; ++i) {
      const PlacedFeature& f = t.features[i];
      for (int r = 0; r < 4; ++r) {
        const BlockRow row = row_of(places[b] + f.offset, r);
        add_matches(row.gradient, 4, f.gradient_bits, f.gradient_weight, gradient + 4 * r);
        add_matches(row.normal, 4, f.normal_bits, f.normal_weight, normal + 4 * r);
      }
    }
    out[b] = {};
    for (int k = 0; k < 16; ++k) {
      out[b].pixels[k] = t.scale.score(gradient[k], normal[k]);
      std::uint16_t& best = out[b].best[k / 8 * 2 + k % 4 / 2];
      best = std::max(best, out[b].pixels[k]);
    }
  }
}

void match_blocks_rearranged(const RearrangedMap& map, const std::ptrdiff_t* places, int count,
                             const PlacedTemplate& t, BlockScores* out) {
  match_blocks(places, count, t, out, [&](std::ptrdiff_t at, int r) {
    const std::uint8_t* block = map.blocks + at;
    return BlockRow{block + 4 * r, block + 16 + 4 * r};
  });
}

void match_blocks_plain(const PlainMaps& maps, const std::ptrdiff_t* places, int count,
                        const PlacedTemplate& t, BlockScores* out) {
  match_blocks(places, count, t, out, [&](std::ptrdiff_t at, int r) {
    return BlockRow{maps.gradient + at + r * maps.stride, maps.normal + at + r * maps.stride};
  });
}

}  // namespace

SearchKernels search_kernels_scalar() {
  return {place_features, scan_cells, match_blocks_rearranged, match_blocks_plain};
}

}  // namespace binpick::simd
