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

// Places features on the plain maps as the scan does: at odd offsets too.
void place_scanned(std::span<const Feature> features, int scale_q8, std::ptrdiff_t stride,
                   simd::PlacedFeature* out);

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
    simd::PlacedTemplate placed;
    std::int16_t viewpoint, roll;
  };
  struct CellEntry {
    std::uint16_t score;
    std::uint16_t template_index;
    std::uint8_t pixel;
  };

  struct Buffers {
    std::span<Template> templates;  // the rolls of a viewpoint follow each other
    std::span<simd::PlacedFeature> features;
    std::span<CellEntry> cells;      // kViewpointsPerCell a cell, best first
    std::span<std::uint16_t> known;  // per thread: what a template must beat, one a cell of a row
    std::span<simd::CellScore> better;  // per thread: the cells where it does
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
                      int distance_index, int threshold);
  void scan_cell_row(int cell_y, CellSpan span, const PyramidLevel& level,
                     const simd::KernelTable& kernels, int thread);
  static void enter(CellEntry* cell, CellEntry entry, int viewpoint_first);
  CellEntry* cell_row(int cell_y) {
    return buffers_.cells.data() +
           static_cast<std::ptrdiff_t>(cell_y) * columns_ * kViewpointsPerCell;
  }

  int row_cells_;  // of `known` and `better` of a thread
  int template_count_ = 0;
  int columns_ = 0;
  Buffers buffers_;
};

}  // namespace binpick
