// Exhaustive scan of the templates of one tree depth over one pyramid level (paper section III-D).
// Keeps the best viewpoints of each cell of 2x2 pixels.
#pragma once

#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/base/worker_pool.hpp"
#include "features/pyramid.hpp"
#include "search/candidate.hpp"
#include "search/distance_gate.hpp"
#include "search/scale_plan.hpp"

namespace binpick {

// Candidates of a cell, each the best roll of another viewpoint: the many rolls of a plain side,
// which fits nearly anything, must leave room for the viewpoint that is right. That one is rarely
// the best, but nearly always among the best ten.
inline constexpr int kViewpointsPerCell = 12;

struct ScanLimits {
  int templates_max = 0;              // of one model and distance at its scan depth
  int features_max = 0;               // of all of those together
  int width_max = 0, height_max = 0;  // px, of the largest scanned level
  int thread_count = 1;
};

class Scanner {
 public:
  static std::size_t footprint(const ScanLimits& limits);
  Scanner(const ScanLimits& limits, Arena& arena);

  // Scans one model at one distance of its scan depth. Writes the candidates with score >=
  // threshold to `out`, cell by cell, and returns how many; those that find no room are counted in
  // `lost`.
  int scan(const ObjectModel& model, int model_index, int distance_index, const ScalePlan& plan,
           const FeaturePyramid& pyramid, const simd::KernelTable& kernels, int threshold,
           WorkerPool& pool, std::span<Candidate> out, int& lost);

 private:
  struct Template {
    int first, count;
    ScoreScale scale;
    std::int16_t viewpoint, roll;
  };
  struct CellEntry {
    std::uint16_t score;
    std::uint16_t template_index;
    std::uint8_t pixel;
  };

  struct Buffers {
    std::span<Template> templates;
    std::span<simd::ScanFeature> features;
    std::span<CellEntry> cells;       // kViewpointsPerCell a cell, best first
    std::span<CellEntry> best_rolls;  // per thread: of one viewpoint, one a cell of a row
    std::span<std::uint16_t> sums;    // per thread: gradient, normal
    std::span<std::uint16_t> scores;  // per thread: two rows
  };
  // The one list of what a scanner takes, from an Arena or an ArenaPlan.
  template <class Source>
  static Buffers take(const ScanLimits& limits, Source& source);
  void load_templates(const ObjectModel& model, int distance_index, const ScalePlan& plan,
                      const FeaturePyramid& pyramid, std::ptrdiff_t stride);
  // The cells of a row between the first and the last at which the distance is possible.
  struct CellSpan {
    int first, end;
  };
  CellSpan open_cells(int cell_y, const PyramidLevel& level, const DistanceGate& gate, int depth,
                      int distance_index) const;
  void scan_cell_row(int cell_y, CellSpan span, const PyramidLevel& level,
                     const simd::KernelTable& kernels, int threshold, int thread);
  void insert(CellEntry* cell, CellEntry entry) const;

  int row_stride_;
  int template_count_ = 0;
  int columns_ = 0;
  Buffers buffers_;
};

}  // namespace binpick
