// The search for one model in one frame: scan, then descent to the leaves of its pose tree.
#pragma once

#include <span>

#include "base/deadline.hpp"
#include "binpick/base/arena.hpp"
#include "binpick/base/clock.hpp"
#include "binpick/report/detection.hpp"
#include "search/descend.hpp"
#include "search/scan.hpp"
#include "search/search_observer.hpp"

namespace binpick {

// How many candidates survive at each depth, counted from the scan depth. A place is a square with
// a fifth of the part's image diameter as its side: the limit per place leaves room for poorly
// visible parts, the one per viewpoint of the scan (origin) for sides that fit less than plain
// ones.
struct SearchParams {
  double score_min = 0.9;           // of both modalities together, 0..2, at every depth
  double gradient_score_min = 0.5;  // without depth, of the gradients alone, 0..1
  int candidates_max[4] = {16000, 10000, 6000, 6000};
  int per_place_max[4] = {24, 24, 16, 16};
  int per_origin_max[4] = {24, 3, 2, 2};
};

struct SearchLimits {
  ScanLimits scan;
  int nodes_max = 0;  // of a tree depth that is descended from
  int region_width_max = 0, region_height_max = 0;
};

struct SearchContext {
  std::span<const ObjectModel> models;
  std::span<const ScalePlan> plans;
  const FeaturePyramid& pyramid;
  const simd::KernelTable& kernels;
  MapLayout layout;
  WorkerPool& pool;
  ClockFn clock;
  Deadline deadline;
  SearchObserver* observer = nullptr;  // of a diagnosis
};

class TreeSearch {
 public:
  static std::size_t footprint(const SearchLimits& limits, const SearchParams& params);
  TreeSearch(const SearchLimits& limits, const SearchParams& params, Arena& arena);

  // Leaf candidates of one model, best first; valid until the next call. Adds its counts and times
  // to the report. None where the deadline comes first.
  std::span<const Candidate> run(const SearchContext& context, int model_index,
                                 DetectionReport& report);

 private:
  struct Buffers {
    std::span<Candidate> found, selected;
    SelectScratch select;
    NodeOrder by_node;
  };
  // The one list of what a search takes beside its scanner, from an Arena or an ArenaPlan.
  template <class Source>
  static Buffers take(const SearchLimits& limits, const SearchParams& params, Source& source);

  SearchParams params_;
  Scanner scanner_;
  Buffers buffers_;
};

}  // namespace binpick
