// Orientation histograms on a square grid of cells, and the reductions of Algorithm 1 (paper
// section III-B).
#pragma once

#include <cstdint>
#include <vector>

#include "features/orientation.hpp"

namespace binpick::train {

// size x size cells of eight bins. Cell i stands for the offset i - size/2 from the object's
// centre, in pixels of the grid's own pyramid level (times `stride` where the grid is coarser than
// the level).
template <class T>
struct HistogramGrid {
  int size = 0;
  std::vector<T> bins;

  explicit HistogramGrid(int cells = 0)
      : size(cells), bins(static_cast<std::size_t>(cells) * cells * kOrientationBins, T{0}) {}
  T* cell(int x, int y) {
    return &bins[(static_cast<std::size_t>(y) * size + x) * kOrientationBins];
  }
  const T* cell(int x, int y) const {
    return &bins[(static_cast<std::size_t>(y) * size + x) * kOrientationBins];
  }
};

// Which two pixels of a finer grid make one of a coarser: 2i, 2i+1 or 2i-1, 2i. The pair's middle
// is half a fine pixel off the point that it stands for; alternating the side keeps the error from
// adding up.
enum class PairSide { kUpper, kLower };

// Adds the 2x2 sums of `fine` to rows [row_first, row_end) of `coarse` (half its size). Pixels
// beyond the border count as empty.
template <class T>
void add_reduced_2x2(const HistogramGrid<T>& fine, PairSide side,
                     HistogramGrid<std::uint32_t>& coarse, int row_first, int row_end) {
  const int shift = side == PairSide::kUpper ? 0 : -1;
  for (int y = row_first; y < row_end; ++y) {
    for (int x = 0; x < coarse.size; ++x) {
      std::uint32_t* sum = coarse.cell(x, y);
      for (int j = 0; j < 2; ++j) {
        const int fy = 2 * y + shift + j;
        if (fy < 0) continue;
        for (int i = 0; i < 2; ++i) {
          const int fx = 2 * x + shift + i;
          if (fx < 0) continue;
          const T* from = fine.cell(fx, fy);
          for (int b = 0; b < kOrientationBins; ++b) sum[b] += from[b];
        }
      }
    }
  }
}

template <class T>
void add_reduced_2x2(const HistogramGrid<T>& fine, PairSide side,
                     HistogramGrid<std::uint32_t>& coarse) {
  add_reduced_2x2(fine, side, coarse, 0, coarse.size);
}

// Adds `weight` times `from` to `sum` in rows [row_first, row_end), cell by cell.
template <class T>
void add_scaled(const HistogramGrid<T>& from, std::uint32_t weight,
                HistogramGrid<std::uint32_t>& sum, int row_first, int row_end) {
  const std::size_t row = static_cast<std::size_t>(sum.size) * kOrientationBins;
  for (std::size_t i = row * static_cast<std::size_t>(row_first);
       i < row * static_cast<std::size_t>(row_end); ++i) {
    sum.bins[i] += weight * from.bins[i];
  }
}

}  // namespace binpick::train
