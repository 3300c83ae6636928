// What training calls indistinguishable: counted over poses found in piles.
#include "training/near_symmetries.hpp"

#include <gtest/gtest.h>

#include "binpick/geometry/angle.hpp"
#include "core/bracket.hpp"
#include "core/symmetry_rows.hpp"

namespace binpick::app {
namespace {

using Which = std::pair<std::vector<bool>, std::vector<bool>>;

// The bracket, said to be nearly the same turned half about z, and rolled about x.
class NearlySymmetric : public ::testing::Test {
 protected:
  NearlySymmetric()
      : bytes_(with_symmetry(bracket_model_bytes(),
                             {turn_row(Vec3::UnitZ(), 180, 0, SymmetryKind::kNear)},
                             {axis_row(Vec3::UnitX(), 0, SymmetryKind::kNear)})) {}

  ObjectModel model() const { return ObjectModel::parse(bytes_).value(); }
  Pose moved(const Vec3& axis, double angle_deg) const {
    const Mat3 R = rotation_from_vector(angle_deg * kDegree * axis);
    return in_cad({R, Vec3::Zero()}, model().centre_mm());
  }

  // A part found at its pose followed by `move`; and another one, far away, for each.
  void add(const Pose& move, double score = 0.1, double visible_fraction = 0.9) {
    ScoredInstance instance;
    instance.truth.obj_id = kPileObject;
    instance.truth.visible_fraction = visible_fraction;
    instance.truth.T_cam_obj =
        bracket_pose(20, 36, 15, Vec3(400.0 * static_cast<double>(count_++), 0, 500));
    trial_.truth[kFrame].push_back(instance);
    again(move, score);
  }
  // The last part found once more.
  void again(const Pose& move, double score) {
    const Pose& truth = trial_.truth[kFrame].back().truth.T_cam_obj;
    trial_.rows.push_back({kFrame, kPileObject, score, truth * move, 0.1});
  }
  Which which() const {
    const train::NearSymmetries found =
        indistinguishable_symmetries(trial_, model(), bracket_mesh(), PoseLimits{});
    return {found.turns, found.axes};
  }

  static constexpr drivers::FrameId kFrame{1, 0};
  std::vector<std::uint8_t> bytes_;
  PileTrial trial_;
  int count_ = 0;
};

TEST_F(NearlySymmetric, OneTimeInFiveIsTooOften) {
  const Pose half = moved(Vec3::UnitZ(), 180);
  for (int i = 0; i < 12; ++i) add(Pose{});
  EXPECT_EQ(which(), Which({false}, {false}));
  for (int i = 0; i < 3; ++i) add(half);
  EXPECT_EQ(which(), Which({false}, {false})) << "3 of 15";
  add(half);
  EXPECT_EQ(which(), Which({true}, {false})) << "4 of 16";
}

TEST_F(NearlySymmetric, FewMayBeChance) {
  add(moved(Vec3::UnitZ(), 180));
  add(moved(Vec3::UnitZ(), 180));
  EXPECT_EQ(which(), Which({false}, {false}));
}

TEST_F(NearlySymmetric, AnyAngleAboutAnAxisCounts) {
  for (const double angle_deg : {20.0, 75.0, 140.0, -110.0}) add(moved(Vec3::UnitX(), angle_deg));
  EXPECT_EQ(which(), Which({false}, {true}));
}

TEST_F(NearlySymmetric, OnlyTheBestPoseAtAMostlyVisiblePartCounts) {
  const Pose half = moved(Vec3::UnitZ(), 180);
  for (int i = 0; i < 5; ++i) {
    add(half, 0.2);
    again(Pose{}, 0.3);
    add(half, 0.9, 0.4);
  }
  EXPECT_EQ(which(), Which({false}, {false}));
}

TEST_F(NearlySymmetric, WhatIsMarkedIsRightFromThenOn) {
  const Pose half = moved(Vec3::UnitZ(), 180), rolled = moved(Vec3::UnitX(), 50);
  const Pose truth = bracket_pose(20, 36, 15, Vec3(0, 0, 500));
  const auto right = [&](const Pose& move) {
    return is_right(geometry_of(model(), bracket_mesh()), truth * move, truth, PoseLimits{});
  };
  EXPECT_FALSE(right(half));
  train::set_indistinguishable(bytes_, {{true}, {false}});
  EXPECT_EQ(model().symmetry().near_turns[0].kind, SymmetryKind::kIndistinguishable);
  EXPECT_EQ(model().symmetry().near_axes[0].kind, SymmetryKind::kNear);
  EXPECT_TRUE(right(half));
  EXPECT_FALSE(right(rolled));
  train::set_indistinguishable(bytes_, {{true}, {true}});
  EXPECT_TRUE(right(rolled));
  EXPECT_TRUE(right(rolled * half));
}

}  // namespace
}  // namespace binpick::app
