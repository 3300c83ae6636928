// The threshold that is suggested, and what is promised of it.
#include "assess/pick_threshold.hpp"

#include <gtest/gtest.h>

namespace binpick::app {
namespace {

// `count` poses of as many parts.
void add(std::vector<ScoredPose>& poses, int count, double score, bool found_again = true) {
  for (int i = 0; i < count; ++i) poses.push_back({score, poses.size(), found_again});
}

TEST(PickThreshold, IsTheLowestAtWhichTheScoresExpectFewWrongPicks) {
  std::vector<ScoredPose> poses;
  add(poses, 80, 0.999);
  add(poses, 20, 0.96);
  add(poses, 20, 0.805);
  const auto two_percent = suggest_threshold(poses, 0.02);
  ASSERT_TRUE(two_percent.has_value());
  EXPECT_DOUBLE_EQ(two_percent->threshold, 0.81);  // the 0.805 would make it 4 %
  EXPECT_EQ(two_percent->poses.count, 100);
  EXPECT_NEAR(two_percent->by_score, (80 * 0.001 + 20 * 0.04) / 100, 1e-12);
  EXPECT_DOUBLE_EQ(two_percent->share(), two_percent->by_score);
  const auto five_percent = suggest_threshold(poses, 0.05);
  ASSERT_TRUE(five_percent.has_value());
  EXPECT_DOUBLE_EQ(five_percent->threshold, 0.01) << "all of them are 3.9 % wrong";
  EXPECT_FALSE(suggest_threshold(poses, 0.0005).has_value());
}

TEST(PickThreshold, PosesThatAreNotFoundAgainCountAsWrongWhateverTheyScore) {
  std::vector<ScoredPose> poses;
  add(poses, 95, 0.999);
  add(poses, 5, 0.92, false);
  const WrongPicks all = wrong_picks(poses, 0.5);
  EXPECT_DOUBLE_EQ(all.share(), 0.05);
  EXPECT_EQ(all.poses.right, 95);
  const auto suggested = suggest_threshold(poses, 0.01);
  ASSERT_TRUE(suggested.has_value());
  EXPECT_DOUBLE_EQ(suggested->threshold, 0.93);
  EXPECT_EQ(suggested->poses.right, 95);
}

TEST(PickThreshold, PromisesByPartsAndNotByTheirRepeatedPoses) {
  std::vector<ScoredPose> poses;
  for (int frame = 0; frame < 50; ++frame)
    for (std::size_t part = 0; part < 10; ++part) poses.push_back({0.995, part, true});
  const auto suggested = suggest_threshold(poses, 0.01);
  ASSERT_TRUE(suggested.has_value());
  EXPECT_EQ(suggested->poses.count, 500);
  EXPECT_EQ(suggested->parts.count, 10);
  EXPECT_LT(1 - suggested->poses.low(), 0.01);
  EXPECT_GT(1 - suggested->parts.low(), 0.25) << "ten parts promise no more";
}

TEST(PickThreshold, WhatItTakesToPromise) {
  const int needed = parts_to_promise(0.01);
  EXPECT_EQ(needed, 381);
  const RightShare one_less{needed - 1, needed - 1};
  EXPECT_GT(1 - one_less.low(), 0.01);
  EXPECT_EQ(parts_to_promise(0.5), 4);
}

TEST(PickThreshold, OfNothingIsNone) {
  EXPECT_FALSE(suggest_threshold({}, 0.01).has_value());
  EXPECT_EQ(wrong_picks({}, 0.85).poses.count, 0);
  EXPECT_EQ(wrong_picks({}, 0.85).share(), 0);
}

}  // namespace
}  // namespace binpick::app
