#include "training/self_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "core/bracket.hpp"

namespace binpick::app {
namespace {

PartGeometry bracket_geometry() {
  drivers::BopModel part;
  part.obj_id = kPileObject;
  part.diameter_mm = train::mesh_bounds(bracket_mesh()).diameter_mm;
  return PartGeometry(part, bracket_mesh());
}

// Ten parts in a row, far from each other, of which the first shows 0.05 and the last 0.95.
PileTrial ten_parts() {
  PileTrial trial;
  for (int i = 0; i < 10; ++i) {
    ScoredInstance instance;
    instance.truth.obj_id = kPileObject;
    instance.truth.T_cam_obj = bracket_pose(20, 36.0 * i, 15.0 * i, Vec3(400.0 * i, 0, 500));
    instance.truth.visible_fraction = 0.05 + 0.1 * i;
    trial.truth[{1, 0}].push_back(instance);
  }
  return trial;
}

const Pose& truth_of(const PileTrial& trial, std::size_t i) {
  return trial.truth.at({1, 0})[i].truth.T_cam_obj;
}

void add_row(PileTrial& trial, const Pose& pose, double score) {
  trial.rows.push_back({{1, 0}, kPileObject, score, pose, 0.1});
}

TEST(SelfTest, CountsWhatIsRightAboveTheThreshold) {
  PileTrial trial = ten_parts();
  add_row(trial, truth_of(trial, 9), 0.9);
  add_row(trial, truth_of(trial, 8), 0.3);  // right, but below
  Pose off = truth_of(trial, 7);
  off.t_mm.x() += 1;  // right within the limits
  add_row(trial, off, 0.8);
  const SelfTest test = judge(trial, bracket_geometry(), 0.5);
  EXPECT_EQ(test.record.piles, 1);
  EXPECT_EQ(test.record.instances, 3) << "0.75, 0.85 and 0.95 are mostly visible";
  EXPECT_DOUBLE_EQ(test.record.recall, 2 / 3.0);
  EXPECT_DOUBLE_EQ(test.record.precision, 1);
  EXPECT_EQ(test.wrong, 0);
  EXPECT_EQ(test.reliability.count, 3);
  EXPECT_EQ(test.reliability.accepted.count, 2);
  EXPECT_EQ(test.reliability.accepted.right, 2);
  EXPECT_EQ(test.bands[9].found, 1);
  EXPECT_EQ(test.bands[8].found, 0);
  EXPECT_EQ(test.bands[7].found, 1);
  EXPECT_EQ(test.bands[0].instances, 1);
}

TEST(SelfTest, NamesTheTurnThatPartsAreConfusedBy) {
  PileTrial trial = ten_parts();
  const Mat3 half_turn = rotation_from_vector({0, kPi, 0});
  const Mat3 nearly = rotation_from_vector({0, kPi - 0.15, 0});
  for (std::size_t i = 0; i < 4; ++i) {
    Pose flipped = truth_of(trial, i);
    flipped.R = flipped.R * (i % 2 == 0 ? half_turn : nearly);
    add_row(trial, flipped, 0.9);
  }
  Pose elsewhere = truth_of(trial, 5);
  elsewhere.t_mm.y() += 150;
  add_row(trial, elsewhere, 0.9);
  const SelfTest test = judge(trial, bracket_geometry(), 0.5);
  EXPECT_EQ(test.wrong, 5);
  ASSERT_EQ(test.confusions.size(), 1u);
  EXPECT_EQ(test.confusions[0].count, 4);
  EXPECT_NEAR(test.confusions[0].angle_deg, 180, 10);
  EXPECT_GT(std::abs(test.confusions[0].axis.y()), 0.98);
  EXPECT_DOUBLE_EQ(test.record.precision, 0);

  const auto sentences = advice(test, bracket_model());
  EXPECT_THAT(sentences, testing::Contains(testing::HasSubstr("4 of 5 wrong poses are turned")));
  EXPECT_THAT(sentences, testing::Contains(testing::HasSubstr("raise min_score")));
}

// Ten bands of visibility with so many parts each, of which found_in(band) are found.
template <class FoundIn>
double visible_fraction_min(int parts_each, FoundIn&& found_in) {
  PileTrial trial;
  for (int band = 0; band < 10; ++band) {
    for (int i = 0; i < parts_each; ++i) {
      ScoredInstance instance;
      instance.truth.obj_id = kPileObject;
      instance.truth.T_cam_obj = bracket_pose(20, 0, 0, Vec3(400.0 * i, 400.0 * band, 500));
      instance.truth.visible_fraction = 0.05 + 0.1 * band;
      trial.truth[{1, 0}].push_back(instance);
      if (i < found_in(band)) add_row(trial, instance.truth.T_cam_obj, 0.9);
    }
  }
  return judge(trial, bracket_geometry(), 0.5).record.visible_fraction_min;
}

TEST(SelfTest, SaysFromWhichVisibleShareHalfOfThePartsAreFound) {
  EXPECT_NEAR(visible_fraction_min(6, [](int band) { return band >= 4 ? 3 : 2; }), 0.4, 1e-9);
}

// Bands of two parts say something only together: 0.7 to 1 six of six, 0.4 to 0.7 two of six.
TEST(SelfTest, JoinsBandsOfFewParts) {
  EXPECT_NEAR(visible_fraction_min(2, [](int band) { return band >= 6 ? 2 : 0; }), 0.7, 1e-9);
}

}  // namespace
}  // namespace binpick::app
