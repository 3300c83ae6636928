#include "pose/select.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "binpick/base/arena_plan.hpp"
#include "binpick/geometry/angle.hpp"
#include "pose/score.hpp"

namespace binpick {
namespace {

// Hypotheses whose centres are this near compete for the same part.
constexpr double kSamePlaceShare = 0.25;  // of the diameter
// The same pose for whoever grips the part.
constexpr double kSamePickShare = 0.05;  // of the diameter
constexpr double kSamePickAngle = 7.5 * kDegree;
// Without depth distances are loose: what may be the same apart from that is compared at one
// distance.
constexpr double kSameDistanceRatio = 0.06;
// What is likelier than not makes others that explain the same redundant when they are twenty times
// less probable.
constexpr double kLikely = 0.5;
constexpr double kLogOddsFarLess = 3;
// Of the hypotheses that the coarse alignment leaves below this, one in three thousand becomes
// likelier than not.
constexpr double kHopelessLogOdds = -8;
// Less than this of the part in sight is no pick.
constexpr double kVisibleFractionMin = 0.2;

// `with` stays; `T` moves along its ray where the two may be at one distance.
Pose at_distance_of(const Pose& with, Pose T) {
  const double ratio = with.t_mm.z() / T.t_mm.z();
  if (std::abs(ratio - 1) < kSameDistanceRatio) T.t_mm *= ratio;
  return T;
}

void add_alternative(const Hypothesis& other, double odds, PoseAmbiguity& ambiguity) {
  ambiguity.odds += odds;
  auto& best = ambiguity.best;
  const auto at = std::find_if(best.begin(), best.end(), [&](const Hypothesis* known) {
    return known == nullptr || odds_alone(*known) < odds;
  });
  if (at == best.end()) return;
  std::move_backward(at, best.end() - 1, best.end());
  *at = &other;
}

struct Neighbours {
  bool duplicate = false;
  int at_place = 0;  // not counted to the end where duplicate
};

class NeighbourSearch {
 public:
  NeighbourSearch(const PoseContext& context, const SuppressLimits& limits, PlaceGrid& grid)
      : context_(context), limits_(limits), grid_(grid) {
    grid_.clear();
  }

  Neighbours around(const Hypothesis& h, std::span<const Hypothesis> kept) const {
    const int index = h.candidate.model;
    const ObjectModel& model = context_.models[h.candidate.model];
    const double diameter_mm = model.info().diameter_mm;
    Neighbours found;
    grid_.visit_near(index, place_of(h), [&](std::size_t i) {
      const Pose& better = kept[i].T_cam_centre;
      const Pose T =
          context_.scene.with_depth ? h.T_cam_centre : at_distance_of(better, h.T_cam_centre);
      found.duplicate = context_.symmetries[h.candidate.model].same(
          better, T, limits_.same_diameters * diameter_mm, limits_.same_angle_rad);
      found.at_place += (better.t_mm - T.t_mm).norm() < kSamePlaceShare * diameter_mm;
      return !found.duplicate;
    });
    return found;
  }
  void add(const Hypothesis& h) { grid_.add(h.candidate.model, place_of(h)); }

 private:
  // In cells so wide that whatever is near is in the next one at most.
  Vec2 place_of(const Hypothesis& h) const {
    const ModelInfo& info = context_.models[h.candidate.model].info();
    const Vec3& t = h.T_cam_centre.t_mm;
    const double near_mm =
        std::max(kSamePlaceShare * info.diameter_mm,
                 limits_.same_diameters * info.diameter_mm +
                     context_.symmetries[h.candidate.model].centre_shift_max_mm());
    if (context_.scene.with_depth) return t.head<2>() / near_mm;
    // Poses on one ray are at one place, and what is near at the nearest distance is so elsewhere.
    return t.head<2>() * (info.distance_min_mm / (t.z() * near_mm));
  }

  const PoseContext& context_;
  const SuppressLimits& limits_;
  PlaceGrid& grid_;
};

}  // namespace

SuppressLimits limits_of_candidates(std::size_t room) {
  return {0.03, 5 * kDegree, 8, room * 3 / 4};
}

SuppressLimits limits_of_aligned() {
  return {0.015, 2.5 * kDegree, 6, 0};
}

SuppressLimits limits_of_duplicates() {
  SuppressLimits limits = limits_of_aligned();
  limits.per_place = std::numeric_limits<int>::max();
  return limits;
}

template <class Source>
Selector::Buffers Selector::take(const SelectorLimits& limits, Source& source) {
  Buffers b;
  b.order =
      source.template take<std::uint32_t>(std::max(limits.candidates_max, limits.hypotheses_max));
  b.kept = source.template take<Hypothesis>(limits.hypotheses_max);
  b.accepted = source.template take<Hypothesis*>(static_cast<std::size_t>(limits.owners_max));
  return b;
}

std::size_t Selector::footprint(const SelectorLimits& limits) {
  ArenaPlan plan;
  PlaceGrid(limits.hypotheses_max, plan);
  take(limits, plan);
  return plan.bytes + Coverage::footprint(limits.width_max, limits.height_max, limits.owners_max,
                                          limits.thread_count);
}

Selector::Selector(const SelectorLimits& limits, Arena& arena)
    : coverage_(limits.width_max, limits.height_max, limits.owners_max, limits.thread_count, arena),
      grid_(limits.hypotheses_max, arena),
      buffers_(take(limits, arena)) {}

std::size_t Selector::suppress(const PoseContext& context, std::span<const Hypothesis> from,
                               const SuppressLimits& limits, std::span<Hypothesis> out,
                               DetectionReport& report) {
  const std::span<std::uint32_t> order = buffers_.order.first(from.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return better_hypothesis(from[a], from[b]); });
  NeighbourSearch search(context, limits, grid_);
  std::size_t kept = 0;
  for (const std::uint32_t i : order) {
    const Hypothesis& h = from[i];
    if (!h.alive) {
      count_drop(report, h.drop_reason);
      continue;
    }
    if (kept == out.size()) {
      count_drop(report, DropReason::kLevelLimit);
      continue;
    }
    const Neighbours near = search.around(h, out.first(kept));
    const bool crowded = kept >= limits.by_rank && near.at_place >= limits.per_place;
    if (near.duplicate || crowded) {
      count_drop(report, near.duplicate ? DropReason::kDuplicate : DropReason::kLevelLimit);
      continue;
    }
    out[kept] = h;
    out[kept++].is_local_best = near.at_place == 0;
    search.add(h);
  }
  return kept;
}

std::size_t Selector::suppress(const PoseContext& context, std::span<Hypothesis> list,
                               const SuppressLimits& limits, DetectionReport& report) {
  const std::size_t kept = suppress(context, list, limits, buffers_.kept, report);
  std::copy_n(buffers_.kept.begin(), kept, list.begin());
  return kept;
}

void Selector::prune(const PoseContext& context, std::span<Hypothesis> ranked) {
  for (Hypothesis& h : ranked) {
    if (h.alive && log_odds_of(h) < kHopelessLogOdds) h.drop(DropReason::kBelowMinScore);
  }
  coverage_.clear(context.scene);
  for (Hypothesis& h : ranked) {
    if (!h.alive || h.score < kLikely || coverage_.owner_of(context, h) != nullptr) continue;
    if (!coverage_.add(context, h)) break;
  }
  constexpr std::size_t kPerTask = 16;
  const std::size_t count = ranked.size();
  const auto tasks = static_cast<int>((count + kPerTask - 1) / kPerTask);
  context.pool.parallel_for(tasks, [&](int task, int thread) {
    const std::size_t first = static_cast<std::size_t>(task) * kPerTask;
    for (Hypothesis& h : ranked.subspan(first, std::min(kPerTask, count - first))) {
      if (!h.alive) continue;
      const Hypothesis* owner = coverage_.owner_of(context, h, thread);
      if (owner == nullptr || owner == &h) continue;
      if (log_odds_of(*owner) - log_odds_of(h) > kLogOddsFarLess)
        h.drop(DropReason::kOverlapsBetter);
    }
  });
}

std::span<Hypothesis* const> Selector::explain(const PoseContext& context,
                                               std::span<Hypothesis> ranked, double min_score,
                                               DetectionReport& report) {
  const auto drop = [&](Hypothesis& h, DropReason reason) {
    h.drop(reason);
    count_drop(report, reason);
  };
  // What is kept of the poses must not depend on what is shown of them; what is less probable than
  // this owns nothing, and conflicts with nothing.
  constexpr double kScoreMin = 0.001;
  coverage_.clear(context.scene);
  for (Hypothesis& h : ranked) {
    if (!h.alive) continue;
    if (const auto objection = objection_to(h, std::min(kScoreMin, min_score))) {
      drop(h, *objection);
    } else if (Hypothesis* owner = coverage_.owner_of(context, h)) {
      add_conflict(context, h, *owner);
      drop(h, DropReason::kOverlapsBetter);
    } else if (!coverage_.add(context, h)) {
      drop(h, DropReason::kResultLimit);
    }
  }
  std::size_t accepted = 0;
  for (Hypothesis* h : coverage_.owners()) {
    h->score = score_of(context, *h);
    if (h->score < min_score) {
      drop(*h, DropReason::kBelowMinScore);
    } else {
      buffers_.accepted[accepted++] = h;
    }
  }
  return buffers_.accepted.first(accepted);
}

std::optional<DropReason> objection_to(const Hypothesis& h, double min_score) {
  const Evidence& e = h.evidence;
  if (e.visible_fraction() < kVisibleFractionMin) return DropReason::kTooHidden;
  if (e.contradicted > e.measured) return DropReason::kContradicted;
  if (h.score < min_score) return DropReason::kBelowMinScore;
  return std::nullopt;
}

void add_conflict(const PoseContext& context, const Hypothesis& other, Hypothesis& owner) {
  const std::size_t index = owner.candidate.model;
  const double odds = odds_alone(other);
  if (other.candidate.model == index) {
    const SymmetryTransforms& symmetries = context.symmetries[index];
    const Pose &a = owner.T_cam_centre, &b = other.T_cam_centre;
    const double near_mm = kSamePickShare * context.models[index].info().diameter_mm;
    if (symmetries.same(a, b, near_mm, kSamePickAngle)) return;
    if (symmetries.looks_same(a, b, near_mm, kSamePickAngle, context.near_symmetry)) {
      add_alternative(other, odds, owner.ambiguity);
      return;
    }
  }
  owner.conflict_odds += odds;
}

}  // namespace binpick
