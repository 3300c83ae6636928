#include "pose/near_poses.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "pose/pose_duel.hpp"

namespace binpick {
namespace {

// Of a variant against the pose found: the search found that one, and noise must not change it.
constexpr double kOddsMin = 2;
// Steps about an axis are looked at as they are; the best ones are refined. They are many, and
// share most of their surface: where the pose is less probable than this they are not worth it.
constexpr double kScoreOfStepsMin = 0.02;
constexpr int kStepsRefined = 2;

// What is left of a pose, and of its variant so far.
struct Challenge {
  const PoseContext& context;
  const ObjectModel& model;
  const PartMoves& moves;
  PredictionGrid grid;
  Pose found;
  PosePrediction of_found, of_variant;  // scratch

  Challenge(const PoseContext& c, const Hypothesis& h)
      : context(c),
        model(c.models[h.candidate.model]),
        moves(c.moves[h.candidate.model]),
        grid(model, c.scene, h.T_cam_centre.t_mm),
        found(h.T_cam_centre) {
    predict(model, c.scene, grid, found, of_found);
  }

  Pose canonical(const Pose& T) const { return moves.canonical(model, T); }

  double odds_of(const Pose& variant) {
    predict(model, context.scene, grid, variant, of_variant);
    return duel(model, context.scene, grid, variant, of_variant, found, of_found);
  }
};

struct Best {
  Hypothesis hypothesis;
  double odds = kOddsMin;
};

double log_odds(double probability) {
  const double p = std::clamp(probability, 1e-4, 1 - 1e-4);
  return std::log(p / (1 - p));
}

// Refines a variant and keeps it when it beats the pose found, and the best variant before, where
// they differ and as a whole.
void offer(Challenge& challenge, const Hypothesis& found, const Pose& start, Best& best) {
  Hypothesis h = found;
  h.T_cam_centre = challenge.canonical(start);
  if (!refine_pose(challenge.context, challenge.model, h.T_cam_centre)) return;
  double odds = challenge.odds_of(h.T_cam_centre);
  verify_pose(challenge.context, h);
  odds += log_odds(h.score) - log_odds(found.score);
  if (odds > best.odds) best = {h, odds};
}

// The most promising steps about the near axes, then refined.
void offer_steps(Challenge& challenge, const Hypothesis& found, const Pose& from,
                 std::span<const Pose> steps, Best& best) {
  struct Step {
    Pose pose;
    double odds = -1e30;
  };
  Step promising[kStepsRefined];
  for (const Pose& step : steps) {
    const Pose T = challenge.canonical(from * step);
    const double odds = challenge.odds_of(T);
    int at = kStepsRefined;
    while (at > 0 && promising[at - 1].odds < odds) --at;
    if (at == kStepsRefined) continue;
    std::copy_backward(promising + at, promising + kStepsRefined - 1, promising + kStepsRefined);
    promising[at] = {T, odds};
  }
  for (const Step& p : promising) {
    if (p.odds > -1e30) offer(challenge, found, p.pose, best);
  }
}

bool settle(const PoseContext& context, Hypothesis& h) {
  Challenge challenge(context, h);
  const PartMoves& moves = challenge.moves;
  Best best;
  for (const Pose& move : moves.near_turns()) offer(challenge, h, h.T_cam_centre * move, best);
  const bool flipped = best.odds > kOddsMin;
  const Pose other_side = best.hypothesis.T_cam_centre;
  if (h.score >= kScoreOfStepsMin)
    offer_steps(challenge, h, h.T_cam_centre, moves.near_steps(), best);
  if (flipped) offer_steps(challenge, h, other_side, moves.near_steps(), best);
  if (!(best.odds > kOddsMin)) return false;
  h = best.hypothesis;
  return true;
}

}  // namespace

SettleOutcome settle_near_poses(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  std::atomic<bool> changed{false}, cut_short{false};
  const int count = static_cast<int>(hypotheses.size());
  context.pool.parallel_for(count, [&](int i, int) {
    Hypothesis& h = hypotheses[static_cast<std::size_t>(i)];
    const PartMoves& moves = context.moves[h.candidate.model];
    if (!h.leads || (moves.near_turns().empty() && moves.near_steps().empty())) return;
    if (context.deadline.passed()) {
      cut_short = true;
    } else if (settle(context, h)) {
      changed = true;
    }
  });
  return {changed, cut_short};
}

}  // namespace binpick
