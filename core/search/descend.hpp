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

// Matches the children of `parents` (nodes of depth `depth` - 1) at depth `depth`. children has
// room for kChildrenKept per parent; entry i * kChildrenKept + k is the k-th best child of parent
// i; unused ones have score 0.
DescendCounts descend(const DescendContext& context, int depth, std::span<const Candidate> parents,
                      std::span<Candidate> children, WorkerPool& pool);

// Sorts candidates best first and keeps at most `limit` of them, and at most `per_place` in each
// square of `place_px` pixels (of level 0) per model, so that a few well-visible parts do not take
// the room of the others. `places` is scratch, one counter per square. Unused entries (score 0) go.
// Returns the number kept.
int select_candidates(std::span<Candidate> candidates, int limit, int per_place, int place_px,
                      const Roi& region, std::span<std::uint16_t> places, int& dropped);

}  // namespace binpick
