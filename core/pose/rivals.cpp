#include "pose/rivals.hpp"

#include <cmath>

#include "pose/score.hpp"

namespace binpick {

void meet_rival(const PoseContext& context, Hypothesis& owner, const Hypothesis& rival) {
  const int model = owner.candidate.model;
  if (rival.candidate.model == model &&
      same_pick(context, model, owner.T_cam_centre, rival.T_cam_centre)) {
    return;
  }
  owner.rival_odds += std::exp(log_odds(terms_of(rival), rival.evidence.seen));
}

void score_beside_rivals(const PoseContext& context, Hypothesis& owner) {
  owner.score = probability(terms_of(owner), owner.evidence.seen,
                            context.models[owner.candidate.model].trials());
}

}  // namespace binpick
