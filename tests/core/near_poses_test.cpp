// Poses that a part may be taken for: the bracket turned half about its middle, so that its base
// lies on itself and its upright and its boss stand at the wrong ends.
#include "pose/near_poses.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "binpick/detect/detector.hpp"
#include "pose/pose_duel.hpp"
#include "seen_bracket.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

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

struct OneBracket : SeenBracket {
  explicit OneBracket(const Pose& T_cam_obj) : SeenBracket(T_cam_obj, part().model(), 0.3) {}
  double odds(const Pose& a, const Pose& b) const {
    const Scene scene(pyramid);
    const PredictionGrid grid(part().model(), scene, truth.t_mm);
    const auto of_a = std::make_unique<PosePrediction>(), of_b = std::make_unique<PosePrediction>();
    predict(part().model(), scene, grid, a, *of_a);
    predict(part().model(), scene, grid, b, *of_b);
    return duel(part().model(), scene, grid, a, *of_a, b, *of_b);
  }
};

TEST(PoseDuel, IsWonByThePoseThatIsThere) {
  for (const Pose& T : three_brackets()) {
    const OneBracket scene(T);
    const Pose turned = scene.truth * part().turn();
    EXPECT_GT(scene.odds(scene.truth, turned), 20);
    EXPECT_NEAR(scene.odds(scene.truth, turned), -scene.odds(turned, scene.truth), 1e-6);
  }
}

TEST(PoseDuel, OfAPoseWithItselfIsEven) {
  const OneBracket scene(three_brackets().front());
  EXPECT_EQ(0, scene.odds(scene.truth, scene.truth));
}

TEST(NearPoses, TheRightOneTakesThePlaceOfTheOneFound) {
  for (const Pose& T : three_brackets()) {
    OneBracket scene(T);
    const Scene seen(scene.pyramid);
    const PoseContext context{part().models, scene.moves, seen, scene.pool, {nullptr, 0}};
    std::vector<Hypothesis> found(3);
    found[0].T_cam_centre = scene.truth * part().turn();
    found[1].T_cam_centre = scene.truth;
    found[2].T_cam_centre = found[0].T_cam_centre;
    found[0].leads = found[1].leads = true;
    for (Hypothesis& h : found) verify_pose(context, h);
    EXPECT_TRUE(settle_near_poses(context, found).changed);
    EXPECT_TRUE(pose_error(found[0].T_cam_centre, scene.truth).within(1, 1));
    EXPECT_TRUE(pose_error(found[1].T_cam_centre, scene.truth).within(1, 1));
    EXPECT_GT(found[0].score, found[2].score);
    // What does not lead at its place is left alone.
    EXPECT_GT(pose_error(found[2].T_cam_centre, scene.truth).angle_deg, 170);
    EXPECT_FALSE(settle_near_poses(context, std::span(found).first(2)).changed);
  }
}

std::int64_t late_ns() {
  return 2;
}

TEST(NearPoses, SayThatTheDeadlineCameFirst) {
  OneBracket scene(three_brackets().front());
  const Scene seen(scene.pyramid);
  std::vector<Hypothesis> found(1);
  found[0].T_cam_centre = scene.truth * part().turn();
  found[0].leads = true;
  const PoseContext late{part().models, scene.moves, seen, scene.pool, {&late_ns, 1}};
  const SettleOutcome outcome = settle_near_poses(late, found);
  EXPECT_TRUE(outcome.cut_short);
  EXPECT_FALSE(outcome.changed);
}

TEST(NearPoses, ADetectorPlansTheirMemory) {
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
