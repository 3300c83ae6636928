// Other poses that look like the one found: about the axis on which the measured surface slips, and
// those of a part's near-symmetries. The bracket turned half about its middle lies on its base all
// the same, with its upright and its boss at the wrong ends.
#include "pose/alternatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "pose/select.hpp"
#include "seen_bracket.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

const Vec3 kMiddle(5, -5, 500);
// More than one pose has alternatives.
constexpr std::size_t kRoom = 40;

Pose turned(const SeenBracket& bracket, double deg) {
  const Pose& truth = bracket.truth;
  return left_increment(truth, Vec3(0, 0, deg * kDegree), Vec3::Zero(), truth.t_mm);
}

// Probable enough, and the best of its place, for alternatives to be tried.
Hypothesis found_at(const Pose& T_cam_centre) {
  Hypothesis h;
  h.T_cam_centre = T_cam_centre;
  h.is_local_best = true;
  h.score = 0.5;
  return h;
}

TEST(SlippageAxis, OfLevelFacesIsTheirNormal) {
  const SeenBracket from_above(bracket_pose(0, 0, 20, kMiddle));
  const auto axis = slippage_axis(bracket_model(), from_above.scene(), from_above.truth);
  ASSERT_TRUE(axis);
  EXPECT_GT(std::abs(axis->direction.z()), 0.99);
}

TEST(SlippageAxis, IsNoneWhereFacesOfAllDirectionsShow) {
  const SeenBracket tilted(bracket_pose(45, 40, 10, kMiddle));
  EXPECT_FALSE(slippage_axis(bracket_model(), tilted.scene(), tilted.truth));
}

TEST(SlippageAxis, IsNoneWhereNothingIsExplained) {
  const SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  Pose elsewhere = bracket.truth;
  elsewhere.t_mm.z() -= 60;
  EXPECT_FALSE(slippage_axis(bracket_model(), bracket.scene(), elsewhere));
}

TEST(Alternatives, BringThePoseThatASearchMissed) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene = bracket.scene();
  const PoseContext context = bracket.context(scene);
  std::vector<Hypothesis> list(kRoom);
  list[0] = found_at(turned(bracket, 75));
  const std::size_t count = add_alternatives(context, list, 1);
  ASSERT_GT(count, 1u);
  const auto added = std::span(list).subspan(1, count - 1);
  align_all(context, fine_alignment(scene), added);
  verify_all(context, added);
  int right = 0;
  for (const Hypothesis& h : added)
    right += h.alive && h.score > 0.5 && pose_error(h.T_cam_centre, bracket.truth).within(1, 1);
  EXPECT_EQ(right, 1);
}

TEST(Alternatives, AreNotTriedForWhatIsImprobableOrNotTheBestOfItsPlace) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene = bracket.scene();
  std::vector<Hypothesis> list(kRoom);
  list[0] = list[1] = found_at(turned(bracket, 75));
  list[0].score = 0.01;
  list[1].score = 0.9;
  list[1].is_local_best = false;
  EXPECT_EQ(add_alternatives(bracket.context(scene), list, 2), 2u);
}

TEST(Alternatives, AreNotTriedWithoutDepth) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  bracket.without_depth();
  const Scene scene = bracket.scene();
  std::vector<Hypothesis> list(kRoom);
  list[0] = found_at(turned(bracket, 75));
  EXPECT_EQ(add_alternatives(bracket.context(scene), list, 1), 1u);
}

TEST(Alternatives, AreDroppedWhereTheDeadlineCameFirst) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene = bracket.scene();
  std::vector<Hypothesis> list(kRoom);
  list[0] = found_at(turned(bracket, 75));
  PoseContext late = bracket.context(scene);
  late.deadline = {[]() -> std::int64_t { return 2; }, 1};
  ASSERT_EQ(add_alternatives(late, list, 1), 2u);
  EXPECT_TRUE(list[0].alive);
  EXPECT_FALSE(list[1].alive);
  EXPECT_EQ(list[1].drop_reason, DropReason::kDeadline);
}

TEST(Alternatives, StayWithinTheList) {
  SeenBracket bracket(bracket_pose(0, 0, 20, kMiddle));
  const Scene scene = bracket.scene();
  std::vector<Hypothesis> list(4, found_at(turned(bracket, 75)));
  EXPECT_EQ(add_alternatives(bracket.context(scene), list, 3), 3u);
}

// The trained bracket, said to be near-symmetric.
struct NearBracket {
  std::vector<std::uint8_t> bytes = with_symmetry(
      bracket_model_bytes(), {turn_row(Vec3::UnitZ(), 180, 0, SymmetryKind::kNear)}, {});
  std::vector<ObjectModel> models = {ObjectModel::parse(bytes).value()};
  const ObjectModel& model() const { return models.front(); }
  Pose turn() const { return move_of(model().symmetry().near_turns.front()); }
};

const NearBracket& part() {
  static const NearBracket once;
  return once;
}

TEST(Alternatives, OfANearSymmetryTheRightOneWins) {
  for (const Pose& T : three_brackets()) {
    SeenBracket bracket(T, part().model(), 0.3);
    const Scene scene = bracket.scene();
    const PoseContext context = bracket.context(scene);
    const SelectorLimits limits{
        bracket.plan.width_max, bracket.plan.height_max, 8, kRoom, kRoom, 1};
    Arena arena(Selector::footprint(limits));
    Selector selector(limits, arena);
    DetectionReport report;
    for (const bool from_turned : {true, false}) {
      std::vector<Hypothesis> list(kRoom);
      list[0].T_cam_centre = from_turned ? bracket.truth * part().turn() : bracket.truth;
      verify_one(context, list[0]);
      const double alone = list[0].rank;
      list[0] = found_at(list[0].T_cam_centre);  // probable, whatever its evidence
      std::size_t count = add_alternatives(context, list, 1);
      ASSERT_GT(count, 1u);
      const auto added = std::span(list).subspan(1, count - 1);
      align_all(context, fine_alignment(scene), added);
      verify_all(context, std::span(list).first(count));
      EXPECT_EQ(list[0].rank, alone) << "what it comes from stays as it was";
      count = selector.suppress(context, std::span(list).first(count), limits_of_aligned(), report);
      EXPECT_TRUE(pose_error(list[0].T_cam_centre, bracket.truth).within(1, 1));
      EXPECT_TRUE(list[0].is_local_best);
      if (from_turned) {
        EXPECT_GT(list[0].rank, 2 * alone);
      }
      for (std::size_t i = 1; i < count; ++i) EXPECT_LT(list[i].rank, list[0].rank);
    }
  }
}

TEST(Alternatives, ADetectorPlansTheirMemory) {
  DetectorLimits limits;
  limits.image_width = 320;
  limits.image_height = 240;
  SerialPool pool;
  const std::size_t bytes = Detector::footprint(part().models, limits, {}, 1);
  Arena arena(bytes);
  const Detector detector(part().models, limits, {}, pool, nullptr, arena);
  EXPECT_EQ(bytes, arena.used_bytes());
}

}  // namespace
}  // namespace binpick
