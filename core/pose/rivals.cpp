#include "pose/rivals.hpp"

#include <cmath>

#include "pose/score.hpp"

namespace binpick {
namespace {

constexpr double kDegree = 3.14159265358979 / 180;
constexpr SameLimits kSamePick{0.05, 7.5 * kDegree};

}  // namespace

void meet_rival(const PoseContext& context, Hypothesis& owner, const Hypothesis& rival) {
  const std::size_t index = owner.candidate.model;
  if (rival.candidate.model == index &&
      context.moves[index].same(owner.T_cam_centre, rival.T_cam_centre,
                                kSamePick.diameters * context.models[index].info().diameter_mm,
                                kSamePick.angle_rad)) {
    return;
  }
  owner.rival_odds += std::exp(log_odds(terms_of(rival), rival.evidence.seen));
}

void score_beside_rivals(const PoseContext& context, Hypothesis& owner) {
  owner.score = probability(terms_of(owner), owner.evidence.seen,
                            context.models[owner.candidate.model].trials());
}

}  // namespace binpick
