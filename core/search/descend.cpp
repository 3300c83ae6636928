#include "search/descend.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

#include "search/distance_gate.hpp"
#include "search/matched_features.hpp"

namespace binpick {
namespace {

// Keeps the best kChildrenKept candidates, best first.
struct BestChildren {
  Candidate* slots;
  void offer(const Candidate& c) {
    if (!(c < slots[kChildrenKept - 1])) return;
    int at = kChildrenKept - 1;
    while (at > 0 && c < slots[at - 1]) {
      slots[at] = slots[at - 1];
      --at;
    }
    slots[at] = c;
  }
};

// Parents that one task matches; those of one node of the tree share the work on its templates.
constexpr int kParentsPerTask = 64;

std::size_t node_of(const TreeDepth& depth, const Candidate& c) {
  return static_cast<std::size_t>(
      (c.distance * static_cast<int>(depth.viewpoints.size()) + c.viewpoint) * depth.roll_count +
      c.roll);
}

// Those of one node follow each other.
std::span<const std::uint32_t> order_by_node(const TreeDepth& depth,
                                             std::span<const Candidate> parents,
                                             const NodeOrder& scratch) {
  const std::size_t nodes = depth.templates.size() * static_cast<std::size_t>(depth.distance_count);
  BINPICK_ASSERT(nodes < scratch.starts.size() && parents.size() <= scratch.order.size());
  const auto starts = scratch.starts.first(nodes + 1);
  std::fill(starts.begin(), starts.end(), 0u);
  for (const Candidate& c : parents) ++starts[node_of(depth, c) + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  for (std::uint32_t i = 0; i < parents.size(); ++i)
    scratch.order[starts[node_of(depth, parents[i])]++] = i;
  return scratch.order.first(parents.size());
}

// Whether one of four scores below 2^15 reaches a bar.
bool any_reaches(const std::uint16_t (&scores)[4], int bar) {
  constexpr std::uint64_t kOnes = 0x0001000100010001, kTops = kOnes << 15;
  std::uint64_t four;
  std::memcpy(&four, scores, sizeof(four));
  return (((four | kTops) - kOnes * static_cast<std::uint64_t>(bar)) & kTops) != 0;
}

void offer_quads(const simd::BlockScores& scores, const Candidate& node, const Candidate& parent,
                 int threshold, BestChildren best) {
  if (!any_reaches(scores.best, std::max<int>(threshold, best.slots[kChildrenKept - 1].score)))
    return;
  for (int quad = 0; quad < 4; ++quad) {
    const int score = scores.best[quad];
    if (score < threshold || score < best.slots[kChildrenKept - 1].score) continue;
    const std::uint16_t* upper = scores.pixels + 8 * (quad / 2) + 2 * (quad % 2);
    const std::uint16_t pixels[4] = {upper[0], upper[1], upper[4], upper[5]};
    Candidate c = node;
    c.x = static_cast<std::int16_t>(2 * parent.x + 2 * (quad % 2));
    c.y = static_cast<std::int16_t>(2 * parent.y + 2 * (quad / 2));
    c.origin = parent.origin;
    c.score = scores.best[quad];
    c.best_pixel = static_cast<std::uint8_t>(std::find(pixels, pixels + 4, c.score) - pixels);
    best.offer(c);
  }
}

// Matches the children of one node at the places of its parents, which `group` lists.
class NodeMatcher {
 public:
  NodeMatcher(const DescendContext& context, int depth, std::span<const Candidate> parents,
              std::span<Candidate> children)
      : context_(context), depth_(depth), parents_(parents), children_(children) {}

  int match(std::span<const std::uint32_t> group) {
    const Candidate& node = parents_[group.front()];
    const ObjectModel& model = context_.models[node.model];
    const Viewpoint& view =
        model.depth(depth_ - 1).viewpoints[static_cast<std::size_t>(node.viewpoint)];
    const int distances = model.depth(depth_).distance_count;
    const PyramidLevel& level = context_.pyramid.level(node.level - 1);
    int matched = 0;
    Candidate child = node;
    child.level = static_cast<std::uint8_t>(node.level - 1);
    for (int k = 2 * node.distance; k < std::min(2 * node.distance + 2, distances); ++k) {
      if (context_.plans[node.model].level[depth_][k] < 0) continue;
      find_places(model, group, level, k);
      if (count_ == 0) continue;
      child.distance = static_cast<std::int16_t>(k);
      for (int v = view.child_first; v < view.child_first + view.child_count; ++v) {
        for (int r = 2 * node.roll; r < 2 * node.roll + 2; ++r) {
          child.viewpoint = static_cast<std::int16_t>(v);
          child.roll = static_cast<std::int16_t>(r);
          match_template(model, child, level);
          matched += count_;
        }
      }
    }
    return matched;
  }

 private:
  simd::MapSteps steps(const PyramidLevel& level) const {
    return context_.layout == MapLayout::kRearranged ? level.rearranged.steps()
                                                     : level.plain.steps();
  }

  // Of the parents at which measured depth allows the distance.
  void find_places(const ObjectModel& model, std::span<const std::uint32_t> group,
                   const PyramidLevel& level, int distance) {
    const DistanceGate gate(model);
    const simd::MapSteps step = steps(level);
    count_ = 0;
    for (const std::uint32_t i : group) {
      const Candidate& p = parents_[i];
      const PyramidLevel& seen = context_.pyramid.level(p.level);
      if (!gate.allows(seen, p.x, p.y, depth_, distance)) continue;
      places_[count_] = p.x * step.x + p.y * step.y;
      at_place_[count_++] = i;
    }
  }

  void match_template(const ObjectModel& model, const Candidate& node, const PyramidLevel& level) {
    const simd::SearchKernels& kernels = context_.kernels.search;
    const TreeDepth& depth = model.depth(depth_);
    const TemplateRange& t =
        depth.templates[static_cast<std::size_t>(node.viewpoint * depth.roll_count + node.roll)];
    const std::span<const Feature> features = matched_features(model, t, context_.pyramid);
    const int count = static_cast<int>(features.size());
    kernels.place_features(features.data(), count,
                           context_.plans[node.model].scale_q8[depth_][node.distance], steps(level),
                           placed_);
    const simd::PlacedTemplate placed{placed_, count, count,
                                      ScoreScale(t.gradient_weight_sum, t.normal_weight_sum)};
    if (context_.layout == MapLayout::kRearranged) {
      kernels.match_blocks_rearranged(level.rearranged, places_, count_, placed, scores_);
    } else {
      kernels.match_blocks_plain(level.plain, places_, count_, placed, scores_);
    }
    for (int i = 0; i < count_; ++i) {
      Candidate* best = &children_[at_place_[i] * static_cast<std::size_t>(kChildrenKept)];
      offer_quads(scores_[i], node, parents_[at_place_[i]], context_.threshold, {best});
    }
  }

  const DescendContext& context_;
  const int depth_;
  const std::span<const Candidate> parents_;
  const std::span<Candidate> children_;
  int count_ = 0;
  std::ptrdiff_t places_[kParentsPerTask];
  std::uint32_t at_place_[kParentsPerTask];
  simd::PlacedFeature placed_[simd::kTemplateFeaturesMax];
  simd::BlockScores scores_[kParentsPerTask];
};

}  // namespace

DescendCounts descend(const DescendContext& context, int depth, std::span<const Candidate> parents,
                      std::span<Candidate> children, const NodeOrder& scratch, WorkerPool& pool) {
  if (parents.empty()) return {};
  const TreeDepth& above = context.models[parents.front().model].depth(depth - 1);
  const std::span<const std::uint32_t> order = order_by_node(above, parents, scratch);
  const std::size_t tasks = (order.size() + kParentsPerTask - 1) / kParentsPerTask;
  std::atomic<std::int64_t> matched{0};
  std::atomic<int> ended{0};
  pool.parallel_for(static_cast<int>(tasks), [&](int task, int) {
    const std::size_t first = static_cast<std::size_t>(task) * kParentsPerTask;
    const auto own =
        order.subspan(first, std::min<std::size_t>(kParentsPerTask, order.size() - first));
    const auto children_of = [&](std::uint32_t i) {
      return children.subspan(i * static_cast<std::size_t>(kChildrenKept), kChildrenKept);
    };
    for (const std::uint32_t i : own) std::ranges::fill(children_of(i), Candidate{});
    NodeMatcher matcher(context, depth, parents, children);
    const auto same_node = [&](std::uint32_t a, std::uint32_t b) {
      return node_of(above, parents[a]) == node_of(above, parents[b]);
    };
    std::int64_t own_matched = 0;
    for (std::size_t i = 0, end = 0; i < own.size(); i = end) {
      while (end < own.size() && same_node(own[i], own[end])) ++end;
      own_matched += matcher.match(own.subspan(i, end - i));
    }
    matched += own_matched;
    ended += static_cast<int>(std::ranges::count_if(
        own, [&](std::uint32_t i) { return children_of(i).front().score == 0; }));
  });
  return {matched, ended};
}

namespace {

// The largest share of each distance so that all together stay within `all`.
int share_of_distance(std::span<const Candidate> candidates, int all, int distance_shift) {
  int counts[kModelDistancesMax] = {};
  int needy = 0;
  for (const Candidate& c : candidates) {
    if (c.score > 0) needy += counts[c.distance >> distance_shift]++ == 0;
  }
  std::sort(counts, counts + kModelDistancesMax);
  int room = all;
  for (const int count : counts) {
    if (count == 0) continue;
    if (count > room / needy) return room / needy;
    room -= count;
    --needy;
  }
  return all;
}

// Copies those with a score, best first; those of equal scores are left in any order. Returns the
// number copied.
int sort_by_score(std::span<const Candidate> found, std::span<Candidate> sorted,
                  std::span<std::uint32_t> starts) {
  BINPICK_ASSERT(sorted.size() >= found.size());
  std::fill(starts.begin(), starts.end(), 0u);
  for (const Candidate& c : found) ++starts[kScoresMax - c.score];
  std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), 0u);
  const int count = static_cast<int>(starts[kScoresMax]);
  for (const Candidate& c : found) {
    if (c.score > 0) sorted[starts[kScoresMax - c.score]++] = c;
  }
  return count;
}

}  // namespace

int select_candidates(std::span<const Candidate> found, std::span<Candidate> selected,
                      const SelectLimits& limits, int place_px, const Roi& region,
                      const SelectScratch& scratch, int& dropped) {
  const int columns = region.width / place_px + 1, rows = region.height / place_px + 1;
  BINPICK_ASSERT(scratch.places.size() >=
                 static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::fill_n(scratch.places.begin(), columns * rows, PlaceCount{});
  const int share = share_of_distance(found, limits.all, limits.distance_shift);
  const int count = sort_by_score(found, selected, scratch.score_starts);
  int of_distance[kModelDistancesMax] = {};
  int kept = 0;
  const auto at = [&](int i) { return selected.begin() + i; };
  for (int i = 0, equal_end = 0; i < count && kept < limits.all; ++i) {
    if (i == equal_end) {
      while (equal_end < count && at(equal_end)->score == at(i)->score) ++equal_end;
      std::sort(at(i), at(equal_end));
    }
    const Candidate& c = *at(i);
    int& here = of_distance[c.distance >> limits.distance_shift];
    const int column = (c.x << c.level) / place_px, row = (c.y << c.level) / place_px;
    PlaceCount& place = scratch.places[static_cast<std::size_t>(row * columns + column)];
    std::uint8_t& of_origin = place.of_origin[c.origin % kOriginsMax];
    if (here == share || place.all == limits.per_place || of_origin == limits.per_origin) continue;
    ++here;
    ++place.all;
    ++of_origin;
    *at(kept++) = c;
  }
  dropped += count - kept;
  return kept;
}

}  // namespace binpick
