// The votes of one rendering for the histograms of leaf templates. A rendering is turned some
// hundred times for one viewpoint, so what does not depend on the turn is prepared, and points lie
// as structures of arrays, which compilers turn into vector code.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "features/orientation.hpp"
#include "train/sample_pool.hpp"

namespace binpick::train {

// Votes are whole numbers: a sample has this many, split between neighbouring bins.
inline constexpr int kVoteUnits = 3;
// Of each rendering every 8th surface pixel votes (every second of the pooled ones), for a cell of
// 2x2 pixels, which makes half a vote per sample and cell; each counts double.
inline constexpr int kSurfaceStride = 8 / kPooledSurfaceStride;
inline constexpr int kSurfaceVote = 2 * kVoteUnits;
// Every second contour pixel votes, twice: neighbours on a contour say the same.
inline constexpr int kContourStride = 2;
inline constexpr int kContourVote = kContourStride * kVoteUnits;

// What one point adds to the bins of its cell.
using CellVote = std::array<std::uint16_t, kOrientationBins>;

// Points of one rendering after a turn: cell, and which vote of the table that goes with it.
struct TurnedPoints {
  std::vector<int> x, y, vote;
};

// All votes that there can be.
class VoteTables {
 public:
  explicit VoteTables(NormalCodebook codebook);
  const CellVote& contour(int vote) const { return contour_[static_cast<std::size_t>(vote)]; }
  const CellVote& surface(int vote) const { return surface_[static_cast<std::size_t>(vote)]; }

 private:
  std::vector<CellVote> contour_, surface_;
};

class SampleVotes {
 public:
  SampleVotes(const RenderedSample& sample, NormalCodebook codebook);

  // Every kContourStride-th point from `start` on, turned, in pixels from the corner of a grid
  // whose middle is at `centre`. May lie outside the grid.
  void turn_contour(int start, float turn_rad, float centre, TurnedPoints& out) const;
  // Every kSurfaceStride-th, in cells of 2x2 pixels.
  void turn_surface(int start, float turn_rad, float centre, TurnedPoints& out) const;

 private:
  struct ContourList {
    std::vector<float> x, y, angle_rad;
  };
  struct SurfaceList {
    std::vector<float> x, y, azimuth_rad;
    std::vector<float> ring;  // share of the vote that goes to the bins of azimuth
  };
  template <int kRing>
  static void choose_votes(const SurfaceList& list, float turn_rad, std::vector<int>& votes);

  int ring_bins_;
  std::array<ContourList, kContourStride> contour_;
  std::array<SurfaceList, kSurfaceStride> surface_;
};

}  // namespace binpick::train
