#include "training/score_calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace binpick::app {
namespace {

// What parts differ by, in the terms of the fit: standard deviations of the prior.
constexpr double kSlopeSpread = 0.5;
constexpr double kOffsetSpread = 2.0;
// A slope that is not positive would turn the order of the scores around.
constexpr double kSlopeMin = 0.2;

double log_odds_of(double score) {
  constexpr double kEdge = 1e-9;
  const double p = std::clamp(score, kEdge, 1 - kEdge);
  return std::log(p / (1 - p));
}

}  // namespace

// Newton's method: the negative log likelihood with this prior is strictly convex.
ScoreCalibration fit_calibration(const std::vector<JudgedScore>& poses) {
  constexpr int kStepsMax = 50;
  const Eigen::Vector2d prior(1, 0);
  const Eigen::Vector2d weight(1 / (kSlopeSpread * kSlopeSpread),
                               1 / (kOffsetSpread * kOffsetSpread));
  Eigen::Vector2d x = prior;
  for (int step = 0; step < kStepsMax; ++step) {
    Eigen::Vector2d slope = weight.cwiseProduct(x - prior);
    Eigen::Matrix2d curvature = weight.asDiagonal();
    for (const JudgedScore& pose : poses) {
      const Eigen::Vector2d terms(log_odds_of(pose.score), 1);
      const double p = 1 / (1 + std::exp(-terms.dot(x)));
      slope += (p - (pose.right ? 1 : 0)) * terms;
      curvature += p * (1 - p) * terms * terms.transpose();
    }
    Eigen::Vector2d change = curvature.ldlt().solve(slope);
    change *=
        std::min(1.0, 1.0 / change.cwiseAbs().maxCoeff());  // no further than it can be trusted
    x -= change;
    if (change.cwiseAbs().maxCoeff() < 1e-9) break;
  }
  return {std::max(x[0], kSlopeMin), x[1]};
}

}  // namespace binpick::app
