// Coarse-to-fine: the children of each candidate are matched at the 4x4 pixels under its 2x2 quad,
// one level down (paper section III-C).
#pragma once

#include <cstdint>
#include <span>

#include "binpick/base/worker_pool.hpp"
#include "binpick/search/map_layout.hpp"
#include "features/pyramid.hpp"
#include "search/candidate.hpp"
#include "search/scale_plan.hpp"

namespace binpick {

// The best quads of all children that a candidate hands down.
inline constexpr int kChildrenKept = 4;

struct DescendContext {
  std::span<const ObjectModel> models;
  std::span<const ScalePlan> plans;  // one per model
  const FeaturePyramid& pyramid;
  const simd::KernelTable& kernels;
  MapLayout layout;
  int threshold;
};

struct DescendCounts {
  std::int64_t templates_matched = 0;
  int parents_ended = 0;  // without a child that reaches the threshold
};

// Scratch that puts parents in the order of their tree nodes: one more start than the depth has
// nodes, and an index for each parent.
struct NodeOrder {
  std::span<std::uint32_t> starts, order;
};

// Matches the children of `parents` (nodes of depth `depth` - 1 of one model) at depth `depth`.
// children has room for kChildrenKept per parent; entry i * kChildrenKept + k is the k-th best
// child of parent i; unused ones have score 0.
DescendCounts descend(const DescendContext& context, int depth, std::span<const Candidate> parents,
                      std::span<Candidate> children, const NodeOrder& scratch, WorkerPool& pool);

// How many candidates go on from a depth: in all, in each square of some pixels, and there from
// each viewpoint of the scan. Scores of small templates scatter more than those of large ones, and
// a far background has room for many, so each distance of the scan has an equal share of all; what
// it does not need goes to the others. `distance_shift`: depths below the scan's.
struct SelectLimits {
  int all, per_place, per_origin, distance_shift;
};

// Viewpoints of the deepest scan.
inline constexpr int kOriginsMax = 42;
struct PlaceCount {
  std::uint16_t all = 0;
  std::uint8_t of_origin[kOriginsMax] = {};
};

// The best score of both modalities.
inline constexpr std::size_t kScoresMax = 2 * kScoreOne;
struct SelectScratch {
  std::span<PlaceCount> places;           // one for each square of the region
  std::span<std::uint32_t> score_starts;  // kScoresMax + 1
};

// Writes candidates to `selected` (room for all that were found), best first and within the limits,
// so that neither a few well-visible parts nor a plain side that fits nearly anything takes the
// room of the others. A place is a square of `place_px` pixels of level 0. Unused entries (score 0)
// go. Returns the number kept.
int select_candidates(std::span<const Candidate> found, std::span<Candidate> selected,
                      const SelectLimits& limits, int place_px, const Roi& region,
                      const SelectScratch& scratch, int& dropped);

}  // namespace binpick
