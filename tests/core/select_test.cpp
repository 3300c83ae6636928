// Which poses survive: duplicates, crowded places, pixels that several poses explain.
#include "pose/select.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "contest.hpp"
#include "pose/score.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

double diameter_mm() {
  return bracket_model().info().diameter_mm;
}

std::vector<double> ranks(const std::vector<Hypothesis>& list) {
  std::vector<double> out;
  for (const Hypothesis& h : list) out.push_back(h.rank);
  return out;
}

using Ranks = std::vector<double>;

TEST(Suppress, KeepsTheBetterOfTwoThatAreOne) {
  Contest c;
  Hypothesis near_turned = c.pose(0, 3);
  near_turned.T_cam_centre = turned(near_turned.T_cam_centre, 2.4);
  const double nearly = 0.014 * diameter_mm(), beyond = 0.016 * diameter_mm();
  EXPECT_EQ(Ranks({5}), ranks(c.suppressed({c.pose(nearly, 4), c.pose(0, 5), near_turned})));
  EXPECT_EQ(2, c.dropped(DropReason::kDuplicate));
  near_turned.T_cam_centre = turned(c.pose(0).T_cam_centre, 2.6);
  EXPECT_EQ(Ranks({5, 4, 3}), ranks(c.suppressed({near_turned, c.pose(beyond, 4), c.pose(0, 5)})));
  EXPECT_EQ(0, c.dropped(DropReason::kDuplicate));
}

TEST(Suppress, KeepsAFewOfEachPlace) {
  Contest c;
  std::vector<Hypothesis> list;
  for (int i = 0; i < 10; ++i) {
    list.push_back(c.pose(0, 20 - i));
    list.back().T_cam_centre = turned(list.back().T_cam_centre, 10 * i);
  }
  list.push_back(c.pose(diameter_mm(), 1));
  EXPECT_EQ(Ranks({20, 19, 18, 17, 16, 15, 1}), ranks(c.suppressed(list)));
  EXPECT_EQ(4, c.dropped(DropReason::kLevelLimit));
  // Of candidates so many survive by their rank alone, and only the rest by their place.
  const SuppressLimits by{0.015, 2.5 * kDegree, 6, 8};
  EXPECT_EQ(Ranks({20, 19, 18, 17, 16, 15, 14, 13, 1}), ranks(c.suppressed(list, by)));
}

TEST(Suppress, TellsTheLocalBest) {
  Contest c;
  const double far_mm = diameter_mm();
  const auto list = c.suppressed({c.pose(1.5, 4), c.pose(0, 5), c.pose(far_mm, 3),
                                  c.pose(far_mm + 1.5, 2), c.pose(-far_mm, 1)});
  ASSERT_EQ(Ranks({5, 4, 3, 2, 1}), ranks(list));
  for (const Hypothesis& h : list) {
    const bool first = h.rank == 5 || h.rank == 3 || h.rank == 1;
    EXPECT_EQ(first, h.is_local_best) << h.rank;
  }
}

TEST(Suppress, CountsWhatWasDroppedBeforeAndWhatFindsNoRoom) {
  Contest c;
  Hypothesis diverged = c.pose(30, 9), late = c.pose(60, 8);
  diverged.drop(DropReason::kPoseDiverged);
  late.drop(DropReason::kDeadline);
  const double far_mm = diameter_mm();
  EXPECT_EQ(
      Ranks({7, 6}),
      ranks(c.suppressed({c.pose(2 * far_mm, 5), diverged, c.pose(far_mm, 6), late, c.pose(0, 7)},
                         limits_of_aligned(), 2)));
  EXPECT_EQ(1, c.dropped(DropReason::kPoseDiverged));
  EXPECT_EQ(1, c.dropped(DropReason::kDeadline));
  EXPECT_EQ(1, c.dropped(DropReason::kLevelLimit));
}

TEST(Suppress, GivesTheSameWhateverTheOrder) {
  Contest c;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-60, 60);
  std::vector<Hypothesis> list;
  for (int i = 0; i < 150; ++i) {
    list.push_back(c.pose(place(random), static_cast<double>(random() % 10)));
    list.back().T_cam_centre = turned(list.back().T_cam_centre, 40 * place(random));
    list.back().candidate.x = static_cast<std::int16_t>(i);  // breaks ties
  }
  const auto first = c.suppressed(list);
  EXPECT_GT(first.size(), 20u);
  EXPECT_LT(first.size(), 100u);
  for (int i = 0; i < 5; ++i) {
    std::shuffle(list.begin(), list.end(), random);
    const auto again = c.suppressed(list);
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t k = 0; k < first.size(); ++k) {
      EXPECT_EQ(first[k].candidate.x, again[k].candidate.x);
      EXPECT_EQ(first[k].is_local_best, again[k].is_local_best);
    }
  }
  // In place it is the same.
  const Scene scene = c.bracket.scene();
  list.resize(c.selector.suppress(c.bracket.context(scene), list, limits_of_aligned(), c.report));
  ASSERT_EQ(first.size(), list.size());
  for (std::size_t k = 0; k < first.size(); ++k)
    EXPECT_EQ(first[k].candidate.x, list[k].candidate.x);
}

// The bracket, said to look the same turned half about an axis beside its middle.
const ObjectModel& symmetric_about(double x_mm) {
  static std::vector<std::vector<std::uint8_t>> files;
  static std::vector<std::unique_ptr<ObjectModel>> models;
  files.push_back(with_symmetry(bracket_model_bytes(), {turn_row(Vec3::UnitZ(), 180, x_mm)}, {}));
  models.push_back(std::make_unique<ObjectModel>(ObjectModel::parse(files.back()).value()));
  return *models.back();
}

TEST(Suppress, PosesThatLookTheSameAreOne) {
  for (const double x_mm : {0.0, 4.0, 25.0}) {  // the farthest shifts the centre by 50 mm
    const ObjectModel& part = symmetric_about(x_mm);
    Contest c(part);
    Hypothesis same = c.pose(0, 4), other = c.pose(0, 3);
    same.T_cam_centre = same.T_cam_centre * move_of(part.symmetry().exact_turns.front());
    other.T_cam_centre =
        other.T_cam_centre * Pose{rotation_from_vector(Vec3(0, 0, kPi / 2)), Vec3(2 * x_mm, 0, 0)};
    EXPECT_EQ(Ranks({5, 3}), ranks(c.suppressed({other, same, c.pose(0, 5)}))) << x_mm;
    EXPECT_EQ(1, c.dropped(DropReason::kDuplicate)) << x_mm;
  }
}

TEST(Suppress, WithoutDepthPosesOnOneRayAreOne) {
  Contest with(bracket_model(), true), without(bracket_model(), false);
  Hypothesis behind = with.pose(0, 4), far_behind = with.pose(0, 3);
  behind.T_cam_centre.t_mm *= 1.05;
  far_behind.T_cam_centre.t_mm *= 1.09;
  const std::vector<Hypothesis> list{with.pose(0, 5), behind, far_behind};
  EXPECT_EQ(Ranks({5, 4, 3}), ranks(with.suppressed(list)));
  EXPECT_EQ(Ranks({5, 3}), ranks(without.suppressed(list)));
}

struct CoverageContest : Contest {
  explicit CoverageContest(bool with_depth = true)
      : Contest(bracket_model(), with_depth),
        scene(bracket.scene()),
        room(Coverage::footprint(scene.depth.width, scene.depth.height, 2, 1)),
        coverage(scene.depth.width, scene.depth.height, 2, 1, room) {
    coverage.clear(scene);
  }
  PoseContext context() { return bracket.context(scene); }
  Scene scene;
  Arena room;
  Coverage coverage;
};

TEST(CoverageOfPixels, BelongsToTheFirstWhileThereIsRoom) {
  CoverageContest c;
  Hypothesis first = c.pose(0), same = c.pose(0.5);
  EXPECT_EQ(c.coverage.owner_of(c.context(), first), nullptr);
  EXPECT_TRUE(c.coverage.add(c.context(), first));
  EXPECT_EQ(c.coverage.owner_of(c.context(), same), &first);
  EXPECT_TRUE(c.coverage.add(c.context(), same));
  EXPECT_EQ(c.coverage.owner_of(c.context(), same), &first) << "cells keep their owner";
  EXPECT_FALSE(c.coverage.add(c.context(), same));
  EXPECT_EQ(c.coverage.owners().size(), 2U);
  c.coverage.clear(c.scene);
  EXPECT_EQ(c.coverage.owner_of(c.context(), same), nullptr);
  EXPECT_TRUE(c.coverage.owners().empty());
}

TEST(CoverageOfPixels, IsAShareOfWhatThePoseExplains) {
  CoverageContest c(false);
  Hypothesis first = c.pose(0), beside = c.pose(0.4 * diameter_mm()), away = c.pose(500);
  ASSERT_TRUE(c.coverage.add(c.context(), first));
  EXPECT_GT(c.coverage.covered(c.context(), first).share, 0.99);
  EXPECT_EQ(c.coverage.covered(c.context(), first).owner, &first);
  EXPECT_GT(c.coverage.covered(c.context(), beside).share, 0.1);
  EXPECT_LT(c.coverage.covered(c.context(), beside).share, 0.8);
  EXPECT_EQ(c.coverage.covered(c.context(), beside).owner, &first);
  EXPECT_EQ(c.coverage.covered(c.context(), away).share, 0) << "beside the image";
  EXPECT_EQ(c.coverage.covered(c.context(), away).owner, nullptr);
}

TEST(Prune, OnlyWhatIsFarLessProbableGoes) {
  Contest c;
  const Hypothesis best = c.verified(c.pose(0).T_cam_centre),
                   as_good = c.verified(c.pose(0.1).T_cam_centre),
                   poor = c.verified(c.pose(3).T_cam_centre);
  Hypothesis beside = poor;
  beside.T_cam_centre = c.pose(500).T_cam_centre;
  ASSERT_GT(best.score, 0.5);
  ASSERT_LT(poor.score, 0.01);
  ASSERT_GT(log_odds_of(poor), -8) << "not hopeless";
  const Scene scene = c.bracket.scene();
  std::vector<Hypothesis> list{best, as_good, poor, beside};
  c.selector.prune(c.bracket.context(scene), list);
  EXPECT_TRUE(list[0].alive);
  EXPECT_TRUE(list[1].alive);
  EXPECT_FALSE(list[2].alive);
  EXPECT_EQ(list[2].drop_reason, DropReason::kOverlapsBetter);
  EXPECT_TRUE(list[3].alive) << "beside the image, so on nobody's pixels";
  // With nothing likely about, the improbable stays.
  std::vector<Hypothesis> alone{poor};
  c.selector.prune(c.bracket.context(scene), alone);
  EXPECT_TRUE(alone[0].alive);
}

TEST(Prune, TheHopelessGoesWhateverIsAbout) {
  Contest c;
  Hypothesis hopeless = c.verified(c.bracket.truth);
  const Hypothesis good = hopeless;
  hopeless.T_cam_centre = c.pose(500).T_cam_centre;
  hopeless.evidence.contradicted = hopeless.evidence.samples / 2;
  ASSERT_LT(log_odds_of(hopeless), -8);
  const Scene scene = c.bracket.scene();
  std::vector<Hypothesis> list{good, hopeless};
  c.selector.prune(c.bracket.context(scene), list);
  EXPECT_TRUE(list[0].alive);
  EXPECT_FALSE(list[1].alive);
  EXPECT_EQ(list[1].drop_reason, DropReason::kBelowMinScore);
}

TEST(Explain, TheBestOwnsThePixelsAndTheOthersCountAgainstIt) {
  Contest c;
  const Hypothesis best = c.verified(c.bracket.truth);
  ASSERT_GT(best.score, 0.5);
  // As good as the best itself, were its evidence right.
  Hypothesis other = best;
  other.T_cam_centre = turned(c.bracket.truth, 40);
  Hypothesis same = best;
  same.T_cam_centre = turned(c.bracket.truth, 3);
  std::vector<Hypothesis> alone{best}, beside_same{best, same}, beside_other{best, other};
  ASSERT_EQ(std::vector<Hypothesis*>{&alone[0]}, c.explained(alone));
  EXPECT_EQ(best.score, alone[0].score);
  ASSERT_EQ(std::vector<Hypothesis*>{&beside_same[0]}, c.explained(beside_same));
  EXPECT_EQ(best.score, beside_same[0].score) << "the same pick";
  ASSERT_EQ(std::vector<Hypothesis*>{&beside_other[0]}, c.explained(beside_other));
  EXPECT_LT(beside_other[0].score, best.score);
  EXPECT_FALSE(beside_other[1].alive);
  EXPECT_EQ(beside_other[1].drop_reason, DropReason::kOverlapsBetter);
  EXPECT_EQ(1, c.dropped(DropReason::kOverlapsBetter));
}

TEST(Explain, DropsWhatItsOwnEvidenceObjectsTo) {
  Contest c;
  const Hypothesis good = c.verified(c.bracket.truth);
  std::vector<Hypothesis> list(4, good);
  list[0].evidence.hidden = list[0].evidence.samples * 9 / 10;
  list[1].evidence.contradicted = list[1].evidence.measured + 1;
  list[2].score = 0.0005;
  ASSERT_EQ(std::vector<Hypothesis*>{&list[3]}, c.explained(list, 0.4));
  EXPECT_EQ(1, c.dropped(DropReason::kTooHidden));
  EXPECT_EQ(1, c.dropped(DropReason::kContradicted));
  EXPECT_EQ(1, c.dropped(DropReason::kBelowMinScore));
  EXPECT_EQ(good.score, list[3].score) << "what is dropped conflicts with nothing";
  EXPECT_EQ(DropReason::kTooHidden, objection_to(list[0], 0));
  EXPECT_EQ(DropReason::kContradicted, objection_to(list[1], 0));
  EXPECT_EQ(DropReason::kBelowMinScore, objection_to(list[2], 0.5));
  EXPECT_FALSE(objection_to(list[2], 0));
  EXPECT_FALSE(objection_to(good, 0.5));
}

// What is shown must not change what is kept.
TEST(Explain, TheMinimumCountsAfterTheConflicts) {
  Contest c;
  const Hypothesis good = c.verified(c.bracket.truth);
  Hypothesis other = good;
  other.T_cam_centre = turned(c.bracket.truth, 40);
  std::vector<Hypothesis> free{good, other}, strict{good, other};
  ASSERT_EQ(1u, c.explained(free).size());
  EXPECT_TRUE(c.explained(strict, free[0].score + 1e-6).empty());
  EXPECT_EQ(1, c.dropped(DropReason::kBelowMinScore));
  EXPECT_EQ(free[0].score, strict[0].score);
}

TEST(Explain, SaysThatThereIsNoRoomForAnotherOwner) {
  Contest c;
  const Hypothesis good = c.verified(c.bracket.truth);
  std::vector<Hypothesis> list(kOwners + 2, good);
  for (std::size_t i = 1; i < list.size();
       ++i)  // on nobody's pixels, with good evidence all the same
    list[i].T_cam_centre.t_mm.x() += 500 * static_cast<double>(i);
  EXPECT_EQ(static_cast<std::size_t>(kOwners), c.explained(list).size());
  EXPECT_EQ(2, c.dropped(DropReason::kResultLimit));
}

TEST(Conflicts, MakeAPoseLessProbableUnlessTheyAreTheSamePick) {
  Contest c;
  const Scene scene = c.bracket.scene();
  const PoseContext context = c.bracket.context(scene);
  Hypothesis owner = c.verified(c.bracket.truth);
  const Hypothesis same = c.verified(turned(c.bracket.truth, 3));
  Hypothesis other = c.verified(turned(c.bracket.truth, 40));
  const double alone = owner.score;
  add_conflict(context, same, owner);
  EXPECT_EQ(score_of(context, owner), alone);
  // As good as the owner itself.
  other.evidence = owner.evidence;
  other.candidate = owner.candidate;
  add_conflict(context, other, owner);
  const double beside_one = score_of(context, owner);
  const auto odds = [](double probability) { return probability / (1 - probability); };
  EXPECT_LT(odds(beside_one), 0.6 * odds(alone));
  add_conflict(context, other, owner);
  EXPECT_LT(score_of(context, owner), beside_one);
}

TEST(Conflicts, TheTermIsTheShareOfTheOdds) {
  EXPECT_NEAR(conflicts_term(std::log(9.0), 18), std::log(3.0), 1e-12);
  EXPECT_NEAR(conflicts_term(std::log(0.01), 0.01), std::log(2.0), 1e-12)
      << "improbable, all of them";
  EXPECT_EQ(conflicts_term(2, 0), 0);
}

}  // namespace
}  // namespace binpick
