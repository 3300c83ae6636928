// Which poses are spared work since another one explains the same pixels.
#include "pose/set_aside.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "seen_bracket.hpp"

namespace binpick {
namespace {

const Vec3 kPlace(5, -5, 500);

struct Contest {
  Contest()
      : bracket(bracket_pose(30, 40, 10, kPlace)),
        scene(bracket.pyramid),
        arena(Claims::footprint(scene.depth.width, scene.depth.height, kOwners, 1)),
        claims(scene.depth.width, scene.depth.height, kOwners, 1, arena) {}

  // At the truth, moved sideways.
  Hypothesis pose(double shift_mm, double score = 0) const {
    Hypothesis h;
    h.T_cam_centre = bracket.truth;
    h.T_cam_centre.t_mm.x() += shift_mm;
    h.score = h.rank = score;
    return h;
  }
  PoseContext context() { return bracket.context(scene); }

  static constexpr int kOwners = 2;
  SeenBracket bracket;
  Scene scene;
  Arena arena;
  Claims claims;
};

TEST(Claims, BelongToTheFirstWhileThereIsRoom) {
  Contest c;
  Hypothesis first = c.pose(0), same = c.pose(0.5);
  c.claims.clear(c.scene);
  EXPECT_EQ(c.claims.owner_of(c.context(), first), nullptr);
  EXPECT_TRUE(c.claims.add(c.context(), first));
  EXPECT_EQ(c.claims.owner_of(c.context(), same), &first);
  EXPECT_TRUE(c.claims.add(c.context(), same));
  EXPECT_EQ(c.claims.owner_of(c.context(), same), &first) << "cells keep their owner";
  EXPECT_FALSE(c.claims.add(c.context(), same));
  EXPECT_EQ(c.claims.owners().size(), 2U);
  c.claims.clear(c.scene);
  EXPECT_EQ(c.claims.owner_of(c.context(), same), nullptr);
  EXPECT_TRUE(c.claims.owners().empty());
}

TEST(SetAside, LeadersAreTheFirstOfTheirPlaces) {
  Contest c;
  const double far_mm = bracket_model().info().diameter_mm;
  std::vector<Hypothesis> list{c.pose(0), c.pose(1), c.pose(far_mm), c.pose(far_mm + 1),
                               c.pose(-far_mm)};
  ASSERT_EQ(leaders_to_front(c.context(), list), 3U);
  const double x_mm = c.bracket.truth.t_mm.x();
  EXPECT_EQ(list[0].T_cam_centre.t_mm.x(), x_mm);
  EXPECT_EQ(list[1].T_cam_centre.t_mm.x(), x_mm + far_mm);
  EXPECT_EQ(list[2].T_cam_centre.t_mm.x(), x_mm - far_mm);
}

TEST(SetAside, WhatIsAsGoodAsCertainSparesTheOthersOnItsPixels) {
  Contest c;
  std::vector<Hypothesis> certain{c.pose(0, 0.999)}, doubtful{c.pose(0, 0.9)},
      others{c.pose(1), c.pose(500)};
  set_aside_explained(c.context(), c.claims, doubtful, others);
  EXPECT_TRUE(others[0].alive) << "nobody is certain yet";
  set_aside_explained(c.context(), c.claims, certain, others);
  EXPECT_FALSE(others[0].alive);
  EXPECT_EQ(others[0].drop_reason, DropReason::kOverlapsBetter);
  EXPECT_TRUE(others[1].alive) << "beside the image, so on nobody's pixels";
  EXPECT_TRUE(certain[0].alive);
}

TEST(SetAside, OnlyWhatIsFarLessProbableIsOutdone) {
  Contest c;
  Hypothesis best = c.pose(0), as_good = c.pose(0.1), poor = c.pose(6);
  for (Hypothesis* h : {&best, &as_good, &poor}) verify_pose(c.context(), *h);
  ASSERT_GT(best.score, 0.5);
  ASSERT_LT(poor.score, 0.01);
  std::vector<Hypothesis> list{best, as_good, poor};
  set_aside_outdone(c.context(), c.claims, list);
  EXPECT_TRUE(list[0].alive);
  EXPECT_TRUE(list[1].alive);
  EXPECT_FALSE(list[2].alive);
  // With nothing likely about, the improbable stays.
  std::vector<Hypothesis> alone{poor};
  set_aside_outdone(c.context(), c.claims, alone);
  EXPECT_TRUE(alone[0].alive);
}

}  // namespace
}  // namespace binpick
