#include "training/score_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace binpick::app {
namespace {

double probability(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

// Poses of a part whose log odds are slope * (by the evidence) + offset.
std::vector<JudgedScore> drawn(double slope, double offset, int count) {
  std::mt19937 random(5);
  std::vector<JudgedScore> poses;
  for (int i = 0; i < count; ++i) {
    const double log_odds = -6 + 12.0 * i / count;
    const bool right = std::uniform_real_distribution<double>(0, 1)(random) <
                       probability(slope * log_odds + offset);
    poses.push_back({probability(log_odds), right});
  }
  return poses;
}

TEST(ScoreCalibration, OfNoPosesIsTheIdentity) {
  const ScoreCalibration fitted = fit_calibration({});
  EXPECT_DOUBLE_EQ(fitted.slope, 1);
  EXPECT_DOUBLE_EQ(fitted.offset, 0);
}

TEST(ScoreCalibration, FindsWhatThePosesWereDrawnFrom) {
  const ScoreCalibration fitted = fit_calibration(drawn(1.4, -1.5, 20000));
  EXPECT_NEAR(fitted.slope, 1.4, 0.08);
  EXPECT_NEAR(fitted.offset, -1.5, 0.12);
}

TEST(ScoreCalibration, OfFewPosesStaysNearTheIdentity) {
  const ScoreCalibration fitted = fit_calibration({{0.5, true}, {0.5, true}});
  EXPECT_NEAR(fitted.slope, 1, 0.01);
  EXPECT_GT(fitted.offset, 0.3);
  EXPECT_LT(fitted.offset, 2);
}

// The likelihood alone would have no maximum.
TEST(ScoreCalibration, StaysFiniteWhereAScoreTellsAllRightFromWrong) {
  std::vector<JudgedScore> poses;
  for (int i = 0; i < 500; ++i) poses.push_back({i < 250 ? 0.3 : 0.7, i >= 250});
  poses.push_back({0, false});
  poses.push_back({1, true});
  const ScoreCalibration fitted = fit_calibration(poses);
  EXPECT_GT(fitted.slope, 1.5);
  EXPECT_LT(fitted.slope, 20);
  EXPECT_NEAR(fitted.offset, 0, 0.1);
}

TEST(ScoreCalibration, NeverTurnsTheOrderAround) {
  std::vector<JudgedScore> poses;
  for (int i = 0; i < 500; ++i) poses.push_back({i < 250 ? 0.2 : 0.8, i < 250});
  EXPECT_GT(fit_calibration(poses).slope, 0);
}

}  // namespace
}  // namespace binpick::app
