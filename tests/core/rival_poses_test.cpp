// Poses that explain the same pixels: which turns the measured surface leaves open, and what rivals
// make of a score.
#include <gtest/gtest.h>

#include <cmath>

#include "pose/loose_turns.hpp"
#include "pose/rivals.hpp"
#include "pose/score.hpp"
#include "seen_bracket.hpp"

namespace binpick {
namespace {

const Vec3 kMiddle(5, -5, 500);

Pose turned(const SeenBracket& bracket, double deg) {
  const Pose& truth = bracket.truth;
  return left_increment(truth, Vec3(0, 0, deg * kDegree), Vec3::Zero(), truth.t_mm);
}

// Probable enough, and the best of its place, for its turns to be tried.
Hypothesis leader_at(const Pose& T_cam_centre) {
  Hypothesis h;
  h.T_cam_centre = T_cam_centre;
  h.leads = true;
  h.score = 0.5;
  return h;
}

TEST(LooseTurn, OfLevelFacesIsAboutTheirNormal) {
  const SeenBracket from_above(bracket_pose(0, 0, 20, kMiddle));
  const auto turn = loose_turn(bracket_model(), Scene(from_above.pyramid), from_above.truth);
  ASSERT_TRUE(turn);
  EXPECT_GT(std::abs(turn->axis.z()), 0.99);
}

TEST(LooseTurn, IsNoneWhereFacesOfAllDirectionsShow) {
  const SeenBracket tilted(bracket_pose(45, 40, 10, kMiddle));
  EXPECT_FALSE(loose_turn(bracket_model(), Scene(tilted.pyramid), tilted.truth));
}

TEST(LooseTurn, IsNoneWhereNothingIsExplained) {
  const SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  Pose elsewhere = bracket.truth;
  elsewhere.t_mm.z() -= 60;
  EXPECT_FALSE(loose_turn(bracket_model(), Scene(bracket.pyramid), elsewhere));
}

TEST(LooseTurns, BringThePoseThatASearchMissed) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene(bracket.pyramid);
  std::vector<Hypothesis> list(12);
  list[0] = leader_at(turned(bracket, 75));
  const int count = add_loose_turns(bracket.context(scene), list, 1);
  ASSERT_GT(count, 1);
  int right = 0;
  for (const Hypothesis& h : std::span(list).subspan(1, static_cast<std::size_t>(count) - 1))
    right += h.alive && h.score > 0.5 && pose_error(h.T_cam_centre, bracket.truth).within(1, 1);
  EXPECT_EQ(right, 1);
}

TEST(LooseTurns, AreNotTriedForWhatIsImprobableOrFollows) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene(bracket.pyramid);
  std::vector<Hypothesis> list(12);
  list[0].leads = true;
  list[0].score = 0.01;
  list[1].score = 0.9;
  list[0].T_cam_centre = list[1].T_cam_centre = turned(bracket, 75);
  EXPECT_EQ(add_loose_turns(bracket.context(scene), list, 2), 2);
}

TEST(LooseTurns, SayThatTheDeadlineCameFirst) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene(bracket.pyramid);
  std::vector<Hypothesis> list(12);
  list[0] = leader_at(turned(bracket, 75));
  PoseContext late = bracket.context(scene);
  late.deadline = {[]() -> std::int64_t { return 2; }, 1};
  ASSERT_EQ(add_loose_turns(late, list, 1), 2);
  EXPECT_FALSE(list[1].alive);
  EXPECT_EQ(list[1].drop_reason, DropReason::kDeadline);
}

TEST(LooseTurns, StayWithinTheList) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene(bracket.pyramid);
  std::vector<Hypothesis> list(4, leader_at(turned(bracket, 75)));
  EXPECT_EQ(add_loose_turns(bracket.context(scene), list, 3), 3);
}

TEST(Rivals, MakeAPoseLessProbableUnlessTheyAreTheSamePick) {
  SeenBracket bracket(bracket_pose(30, 40, 10, kMiddle));
  const Scene scene(bracket.pyramid);
  const PoseContext context = bracket.context(scene);
  Hypothesis owner, same, other;
  owner.T_cam_centre = bracket.truth;
  same.T_cam_centre = turned(bracket, 3);
  other.T_cam_centre = turned(bracket, 40);
  for (Hypothesis* h : {&owner, &same, &other}) verify_pose(context, *h);
  const double alone = owner.score;
  meet_rival(context, owner, same);
  score_beside_rivals(context, owner);
  EXPECT_EQ(owner.score, alone);
  // As good as the owner itself.
  other.evidence = owner.evidence;
  other.candidate = owner.candidate;
  meet_rival(context, owner, other);
  score_beside_rivals(context, owner);
  const auto odds = [](double probability) { return probability / (1 - probability); };
  EXPECT_LT(odds(owner.score), 0.6 * odds(alone));
  const double beside_one = owner.score;
  meet_rival(context, owner, other);
  score_beside_rivals(context, owner);
  EXPECT_LT(owner.score, beside_one);
}

TEST(Rivals, TheTermIsTheShareOfTheOdds) {
  EXPECT_NEAR(rivals_term(std::log(9.0), 18), std::log(3.0), 1e-12);
  EXPECT_NEAR(rivals_term(std::log(0.01), 0.01), std::log(2.0), 1e-12) << "improbable, all of them";
  EXPECT_EQ(rivals_term(2, 0), 0);
}

}  // namespace
}  // namespace binpick
