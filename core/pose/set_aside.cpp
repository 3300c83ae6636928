#include "pose/set_aside.hpp"

#include <algorithm>
#include <utility>

#include "pose/score.hpp"

namespace binpick {
namespace {

// Probabilities after ICP. What is to come of a pose that is this probable settles its pixels, and
// whatever else explains them need not be looked at.
constexpr double kAsGoodAsCertain = 0.99;
// What is likelier than not is compared with what explains the same, and outdoes what is twenty
// times less probable: the last refinement does not make up for that.
constexpr double kLikely = 0.5;
constexpr double kLogOddsOutdone = 3;

void claim_from(const PoseContext& context, Claims& claims, std::span<Hypothesis> ranked,
                double score_min) {
  claims.clear(context.scene);
  for (Hypothesis& h : ranked) {
    if (!h.alive || h.score < score_min || claims.owner_of(context, h) != nullptr) continue;
    if (!claims.add(context, h)) return;
  }
}

// Of the living, those of which `outdone` holds, told who owns what they explain.
template <class Outdone>
void drop_owned(const PoseContext& context, const Claims& claims, std::span<Hypothesis> hypotheses,
                Outdone&& outdone) {
  constexpr std::size_t kPerTask = 16;
  const std::size_t count = hypotheses.size();
  const auto tasks = static_cast<int>((count + kPerTask - 1) / kPerTask);
  context.pool.parallel_for(tasks, [&](int task, int thread) {
    const std::size_t first = static_cast<std::size_t>(task) * kPerTask;
    for (Hypothesis& h : hypotheses.subspan(first, std::min(kPerTask, count - first))) {
      if (!h.alive) continue;
      const Hypothesis* owner = claims.owner_of(context, h, thread);
      if (owner != nullptr && owner != &h && outdone(*owner, h))
        h.drop(DropReason::kOverlapsBetter);
    }
  });
}

double log_odds_of(const Hypothesis& h) {
  return log_odds(terms_of(h), h.evidence.seen);
}

}  // namespace

std::size_t leaders_to_front(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  std::size_t leaders = 0;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Hypothesis& h = hypotheses[i];
    const auto same_place = [&](const Hypothesis& leader) {
      return leader.candidate.model == h.candidate.model && at_one_place(context, leader, h);
    };
    const auto end = hypotheses.begin() + static_cast<std::ptrdiff_t>(leaders);
    if (std::none_of(hypotheses.begin(), end, same_place))
      std::swap(hypotheses[leaders++], hypotheses[i]);
  }
  return leaders;
}

void set_aside_explained(const PoseContext& context, Claims& claims, std::span<Hypothesis> verified,
                         std::span<Hypothesis> others) {
  std::sort(verified.begin(), verified.end(), better_hypothesis);
  claim_from(context, claims, verified, kAsGoodAsCertain);
  drop_owned(context, claims, others, [](const Hypothesis&, const Hypothesis&) { return true; });
}

void set_aside_outdone(const PoseContext& context, Claims& claims, std::span<Hypothesis> ranked) {
  claim_from(context, claims, ranked, kLikely);
  drop_owned(context, claims, ranked, [](const Hypothesis& owner, const Hypothesis& h) {
    return log_odds_of(owner) - log_odds_of(h) > kLogOddsOutdone;
  });
}

}  // namespace binpick
