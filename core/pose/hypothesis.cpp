#include "pose/hypothesis.hpp"

#include <algorithm>
#include <cmath>

#include "pose/score.hpp"

namespace binpick {
namespace {

template <class Fn>
void for_living(const PoseContext& context, std::span<Hypothesis> hypotheses, Fn&& fn) {
  constexpr int kPerTask = 4;
  const int count = static_cast<int>(hypotheses.size());
  context.pool.parallel_for((count + kPerTask - 1) / kPerTask, [&](int task, int) {
    bool late = false;  // what is dropped takes no time: the clock is not asked again
    for (int i = task * kPerTask; i < std::min(count, (task + 1) * kPerTask); ++i) {
      Hypothesis& h = hypotheses[static_cast<std::size_t>(i)];
      if (!h.alive) continue;
      late = late || context.deadline.passed();
      if (late) {
        h.drop(DropReason::kDeadline);
      } else {
        fn(h);
      }
    }
  });
}

// Without the conflicts with others.
ScoreTerms own_terms(const Hypothesis& h) {
  return score_terms(h.evidence, static_cast<double>(h.candidate.score) / kScoreOne);
}

}  // namespace

bool better_hypothesis(const Hypothesis& a, const Hypothesis& b) {
  if (a.alive != b.alive) return a.alive;
  if (a.rank != b.rank) return a.rank > b.rank;
  return a.candidate < b.candidate;
}

void count_drop(DetectionReport& report, DropReason reason) {
  ++report.dropped[static_cast<std::size_t>(reason)];
}

ScoreTerms terms_of(const Hypothesis& h) {
  ScoreTerms terms = own_terms(h);
  terms[static_cast<std::size_t>(ScoreTerm::kConflicts)] =
      conflicts_term(log_odds(terms, h.evidence.seen), h.conflict_odds);
  return terms;
}

double log_odds_of(const Hypothesis& h) {
  return log_odds(terms_of(h), h.evidence.seen);
}

double odds_alone(const Hypothesis& h) {
  return std::exp(log_odds(own_terms(h), h.evidence.seen));
}

double score_of(const PoseContext& context, const Hypothesis& h) {
  return probability(terms_of(h), h.evidence.seen, context.models[h.candidate.model].trials());
}

void align_one(const PoseContext& context, std::span<const AlignStep> schedule, Hypothesis& h) {
  const ObjectModel& model = context.models[h.candidate.model];
  h.T_cam_centre =
      context.symmetries[h.candidate.model].canonical(model, context.scene.kernels, h.T_cam_centre);
  if (!align(model, context.scene, schedule, h.T_cam_centre)) h.drop(DropReason::kPoseDiverged);
}

void verify_one(const PoseContext& context, Hypothesis& h) {
  const ObjectModel& model = context.models[h.candidate.model];
  h.T_cam_centre =
      context.symmetries[h.candidate.model].canonical(model, context.scene.kernels, h.T_cam_centre);
  h.evidence = verify(model, context.scene, h.T_cam_centre);
  h.score = probability(terms_of(h), h.evidence.seen, ModelTrials{});
  h.rank = h.evidence.explained_mm2 * h.score;
}

void align_all(const PoseContext& context, std::span<const AlignStep> schedule,
               std::span<Hypothesis> hypotheses) {
  for_living(context, hypotheses, [&](Hypothesis& h) { align_one(context, schedule, h); });
}

void verify_all(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  for_living(context, hypotheses, [&](Hypothesis& h) { verify_one(context, h); });
}

}  // namespace binpick
