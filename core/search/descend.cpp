#include "search/descend.hpp"

#include <algorithm>
#include <atomic>

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

int match_children(const DescendContext& context, int depth, const Candidate& parent,
                   Candidate* out) {
  const ObjectModel& model = context.models[parent.model];
  const TreeDepth& below = model.depth(depth);
  const Viewpoint& view =
      model.depth(depth - 1).viewpoints[static_cast<std::size_t>(parent.viewpoint)];
  const ScalePlan& plan = context.plans[parent.model];
  const PyramidLevel& level = context.pyramid.level(parent.level - 1);
  const PyramidLevel& seen = context.pyramid.level(parent.level);
  const DistanceGate gate(model);
  BestChildren best{out};
  int matched = 0;
  for (int k = 2 * parent.distance; k < std::min(2 * parent.distance + 2, below.distance_count);
       ++k) {
    if (plan.level[depth][k] < 0) continue;
    if (!gate.allows(seen, parent.x, parent.y, depth, k)) continue;
    const int scale_q8 = plan.scale_q8[depth][k];
    for (int v = view.child_first; v < view.child_first + view.child_count; ++v) {
      for (int r = 2 * parent.roll; r < 2 * parent.roll + 2; ++r) {
        const TemplateRange& t =
            below.templates[static_cast<std::size_t>(v * below.roll_count + r)];
        const std::span<const Feature> features = matched_features(model, t, context.pyramid);
        const int count = static_cast<int>(features.size());
        simd::BlockSums sums;
        const int x = 2 * parent.x, y = 2 * parent.y;
        if (context.layout == MapLayout::kRearranged) {
          context.kernels.search.match_block_rearranged(level.rearranged, x, y, features.data(),
                                                        count, scale_q8, sums);
        } else {
          context.kernels.search.match_block_plain(level.plain, x, y, features.data(), count,
                                                   scale_q8, sums);
        }
        ++matched;
        const ScoreScale scale(t.gradient_weight_sum, t.normal_weight_sum);
        for (int quad = 0; quad < 4; ++quad) {
          Candidate c = parent;
          c.x = static_cast<std::int16_t>(x + 2 * (quad % 2));
          c.y = static_cast<std::int16_t>(y + 2 * (quad / 2));
          c.viewpoint = static_cast<std::int16_t>(v);
          c.roll = static_cast<std::int16_t>(r);
          c.distance = static_cast<std::int16_t>(k);
          c.level = static_cast<std::uint8_t>(parent.level - 1);
          c.score = 0;
          for (int p = 0; p < 4; ++p) {
            const int i = (2 * (quad / 2) + p / 2) * 4 + 2 * (quad % 2) + p % 2;
            const std::uint16_t s = scale.score(sums.gradient[i], sums.normal[i]);
            if (s <= c.score) continue;
            c.score = s;
            c.best_pixel = static_cast<std::uint8_t>(p);
          }
          if (c.score >= context.threshold) best.offer(c);
        }
      }
    }
  }
  return matched;
}

}  // namespace

DescendCounts descend(const DescendContext& context, int depth, std::span<const Candidate> parents,
                      std::span<Candidate> children, WorkerPool& pool) {
  constexpr int kParentsPerTask = 32;
  const int count = static_cast<int>(parents.size());
  std::atomic<std::int64_t> matched{0};
  std::atomic<int> ended{0};
  pool.parallel_for((count + kParentsPerTask - 1) / kParentsPerTask, [&](int task, int) {
    std::int64_t own = 0;
    int own_ended = 0;
    for (int i = task * kParentsPerTask; i < std::min(count, (task + 1) * kParentsPerTask); ++i) {
      Candidate* out = &children[static_cast<std::size_t>(i) * kChildrenKept];
      std::fill_n(out, kChildrenKept, Candidate{});
      own += match_children(context, depth, parents[static_cast<std::size_t>(i)], out);
      own_ended += out->score == 0;
    }
    matched += own;
    ended += own_ended;
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

}  // namespace

int select_candidates(std::span<Candidate> candidates, const SelectLimits& limits, int place_px,
                      const Roi& region, std::span<PlaceCount> places, int& dropped) {
  std::sort(candidates.begin(), candidates.end());
  const int columns = region.width / place_px + 1, rows = region.height / place_px + 1;
  BINPICK_ASSERT(places.size() >=
                 static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::fill_n(places.begin(), columns * rows, PlaceCount{});
  const int share = share_of_distance(candidates, limits.all, limits.distance_shift);
  int of_distance[kModelDistancesMax] = {};
  int kept = 0;
  for (const Candidate& c : candidates) {
    if (c.score == 0) break;
    int& here = of_distance[c.distance >> limits.distance_shift];
    const int column = (c.x << c.level) / place_px, row = (c.y << c.level) / place_px;
    PlaceCount& place = places[static_cast<std::size_t>(row * columns + column)];
    std::uint8_t& of_origin = place.of_origin[c.origin % kOriginsMax];
    if (kept == limits.all || here == share || place.all == limits.per_place ||
        of_origin == limits.per_origin) {
      ++dropped;
      continue;
    }
    ++here;
    ++place.all;
    ++of_origin;
    candidates[static_cast<std::size_t>(kept++)] = c;
  }
  return kept;
}

}  // namespace binpick
