// Poses that look the same make each other ambiguous, and not less right.
#include <array>
#include <memory>

#include "contest.hpp"
#include "detect/detection_of.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

// The bracket, said to look the same turned half about an axis, as training finds or does not find
// out.
const ObjectModel& nearly_symmetric(SymmetryKind kind) {
  static std::vector<std::vector<std::uint8_t>> files;
  static std::vector<std::unique_ptr<ObjectModel>> models;
  files.push_back(
      with_symmetry(bracket_model_bytes(), {turn_row(Vec3::UnitZ(), 180, 0, kind)}, {}));
  models.push_back(std::make_unique<ObjectModel>(ObjectModel::parse(files.back()).value()));
  return *models.back();
}

TEST(PoseAmbiguity, TakesNothingFromTheScore) {
  for (const bool told : {false, true}) {
    Contest c(nearly_symmetric(told ? SymmetryKind::kNear : SymmetryKind::kIndistinguishable));
    const Scene scene = c.bracket.scene();
    Hypothesis owner = c.verified(c.bracket.truth);
    // As good as the owner itself.
    Hypothesis other = owner;
    other.T_cam_centre = owner.T_cam_centre * Pose{rotation_from_vector({0, 0, kPi}), Vec3::Zero()};
    std::vector<Hypothesis> list{owner, other};
    ASSERT_EQ(std::vector<Hypothesis*>{&list[0]}, c.explained(list));
    const Detection d = detection_of(c.bracket.context(scene), list[0]);
    EXPECT_EQ(list[0].score < owner.score, told);
    EXPECT_EQ(d.symmetric, !told);
    EXPECT_EQ(pose_ambiguous(d), !told);
    ASSERT_EQ(d.alternative_count, told ? 0 : 1);
    if (told) continue;
    EXPECT_NEAR(d.pose_probability, 0.5, 1e-9);
    EXPECT_NEAR(d.alternatives[0].probability, 0.5, 1e-9);
    EXPECT_NEAR(rotation_angle_between(d.alternatives[0].T_cam_obj.R, d.T_cam_obj.R), kPi, 1e-6);
  }
}

TEST(PoseAmbiguity, WhoAsksMayDecideWhatIsOnePose) {
  struct Case {
    SymmetryKind found;
    NearSymmetry asked;
    bool one;
  };
  for (const Case& k : {Case{SymmetryKind::kNear, NearSymmetry::kEquivalent, true},
                        Case{SymmetryKind::kIndistinguishable, NearSymmetry::kEquivalent, true},
                        Case{SymmetryKind::kNear, NearSymmetry::kDistinct, false},
                        Case{SymmetryKind::kIndistinguishable, NearSymmetry::kDistinct, false}}) {
    Contest c(nearly_symmetric(k.found));
    const Scene scene = c.bracket.scene();
    PoseContext context = c.bracket.context(scene);
    context.near_symmetry = k.asked;
    Hypothesis owner = c.verified(c.bracket.truth);
    Hypothesis other = owner;
    other.T_cam_centre = owner.T_cam_centre * Pose{rotation_from_vector({0, 0, kPi}), Vec3::Zero()};
    add_conflict(context, other, owner);
    EXPECT_EQ(owner.conflict_odds > 0, !k.one);
    EXPECT_EQ(owner.ambiguity.odds > 0, k.one);
    EXPECT_EQ(detection_of(context, owner).symmetric, k.one);
  }
}

TEST(PoseAmbiguity, OfManyThatLookTheSameTheMostProbableAreKept) {
  Contest c(nearly_symmetric(SymmetryKind::kIndistinguishable));
  const Scene scene = c.bracket.scene();
  const PoseContext context = c.bracket.context(scene);
  Hypothesis owner = c.verified(c.bracket.truth);
  std::vector<Hypothesis> others(kPoseAlternativesMax + 2, owner);
  double odds = 0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double tilt = 0.01 * static_cast<double>(i);
    others[i].T_cam_centre =
        owner.T_cam_centre * Pose{rotation_from_vector({0, 0, kPi - tilt}), Vec3::Zero()};
    others[i].evidence.hidden += static_cast<int>(7 * i % 5);  // 0 2 4 1 3
    add_conflict(context, others[i], owner);
    odds += odds_alone(others[i]);
  }
  EXPECT_NEAR(owner.ambiguity.odds, odds, 1e-9 * odds);
  const std::array<const Hypothesis*, 3> best{&others[0], &others[3], &others[1]};
  EXPECT_EQ(owner.ambiguity.best, best);
  EXPECT_EQ(owner.conflict_odds, 0);
}

}  // namespace
}  // namespace binpick
