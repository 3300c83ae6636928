// The cycle's state machine: every cause, what stays latched, frames of reference, ranking.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <set>

#include "daemon/answer_of_result.hpp"
#include "modbus/answer.hpp"
#include "station_bench.hpp"

namespace binpick::app {
namespace {

constexpr std::uint16_t bit(NoPickReason reason) {
  return static_cast<std::uint16_t>(reason);
}

Order order_of(OrderCode code, int Order::*field, int value) {
  Order order;
  order.code = code;
  order.*field = value;
  return order;
}

TEST(Cycle, FindsRanksAndTells) {
  StationBench bench;
  const CycleResult& r = bench.run(OrderCode::kDetect);
  EXPECT_EQ(Cause::kDone, r.cause);
  EXPECT_EQ(StationState::kDone, bench.cycle().state());
  ASSERT_EQ(3u, r.picks.size());
  EXPECT_EQ(3, r.detections);
  EXPECT_EQ(1, r.page);
  EXPECT_EQ(1u, r.cycle);
  EXPECT_EQ(1, r.recipe);
  EXPECT_GT(r.times.detect_ms, 0);
  EXPECT_GE(r.times.total_ms, r.times.grab_ms + r.times.detect_ms);
  EXPECT_NE(0, r.capture_ns);
  EXPECT_NEAR(
      static_cast<double>(r.capture_unix_ns) * 1e-9,
      static_cast<double>(std::chrono::system_clock::now().time_since_epoch().count()) * 1e-9, 60);
  EXPECT_GE(r.picks[0].score, r.picks[1].score);
  EXPECT_GE(r.picks[1].score, r.picks[2].score);
}

TEST(Cycle, CaptureThenProcessGivesWhatDetectGives) {
  StationBench bench;
  std::vector<Pick> detected;
  for (const Pick& pick : bench.run(OrderCode::kDetect).picks) detected.push_back(pick);
  const CycleResult& captured = bench.run(OrderCode::kCapture);
  EXPECT_EQ(Cause::kDone, captured.cause);
  EXPECT_TRUE(captured.picks.empty());
  const std::int64_t capture_ns = captured.capture_ns;
  for (int i = 0; i < 2; ++i) {  // and again, with another recipe say
    const CycleResult& processed = bench.run(OrderCode::kProcess);
    EXPECT_EQ(Cause::kDone, processed.cause);
    EXPECT_EQ(capture_ns, processed.capture_ns);
    ASSERT_EQ(detected.size(), processed.picks.size());
    for (std::size_t k = 0; k < detected.size(); ++k)
      EXPECT_EQ(detected[k].T_ref_pick.t_mm, processed.picks[k].T_ref_pick.t_mm);
  }
  EXPECT_EQ(2, bench.source.grabs);
}

TEST(Cycle, AFrameThatDidNotComeLeavesNothingToProcess) {
  StationBench bench;
  ASSERT_EQ(Cause::kDone, bench.run(OrderCode::kCapture).cause);
  bench.source.error = ErrorCode::kSensorLost;
  EXPECT_EQ(Cause::kSensorLost, bench.run(OrderCode::kCapture).cause);
  EXPECT_EQ(Cause::kNothingCaptured, bench.run(OrderCode::kProcess).cause);
}

// What becomes of what a source of frames says.
constexpr std::pair<ErrorCode, Cause> kErrors[] = {
    {ErrorCode::kSensorTimeout, Cause::kSensorTimeout},
    {ErrorCode::kSensorLost, Cause::kSensorLost},
    {ErrorCode::kSensorEnd, Cause::kSensorLost},
    {ErrorCode::kSensorFrameDropped, Cause::kFrameDamaged},
    {ErrorCode::kSensorRefused, Cause::kSensorRefused},
    {ErrorCode::kArenaTooSmall, Cause::kInternalFault}};

TEST(Cycle, ARecipeChoosesTheImages) {
  StationBench bench;
  bench.config.recipes[0].modality = Modality::kIntensity;
  bench.config.recipes[0].min_score = 0.05;  // intensity alone is never sure
  const CycleResult& r = bench.run(OrderCode::kDetect);
  EXPECT_EQ(Cause::kDone, r.cause);
  ASSERT_FALSE(r.picks.empty());
  std::vector<Vec3> with_depth;
  for (const Pick& pick : r.picks) with_depth.push_back(pick.T_ref_pick.t_mm);
  bench.source.without_depth = true;
  bench.run(OrderCode::kDetect);
  ASSERT_EQ(with_depth.size(), r.picks.size()) << "depth was not looked at";
  for (std::size_t i = 0; i < with_depth.size(); ++i)
    EXPECT_EQ(with_depth[i], r.picks[i].T_ref_pick.t_mm);
  bench.source.without_depth = false;
  bench.source.without_intensity = true;
  bench.run(OrderCode::kDetect);
  EXPECT_EQ(Cause::kDetectionFailed, r.cause);
  EXPECT_EQ(ErrorCode::kFrameWithoutIntensity, r.error.code);
  EXPECT_TRUE(r.picks.empty());
}

TEST(Cycle, AReloadChangesTheImagesLookedAt) {
  StationBench bench;
  bench.source.without_depth = true;
  EXPECT_EQ(Cause::kDone, bench.run(OrderCode::kDetect).cause) << "automatic: what there is";
  bench.config.recipes[0].modality = Modality::kDepth;
  bench.recipes->take_live_values(bench.config.recipes);
  EXPECT_EQ(Cause::kDetectionFailed, bench.run(OrderCode::kDetect).cause);
  EXPECT_EQ(ErrorCode::kFrameWithoutDepth, bench.cycle().result().error.code);
}

TEST(Cycle, EveryCauseIsReached) {
  std::set<Cause> reached;
  StationBench bench;
  bench.config.station.deadline_min_ms = 5;
  const auto expect_cause = [&](Cause cause, const CycleResult& r) {
    EXPECT_EQ(cause, r.cause) << cause_name(r.cause);
    if (cause == r.cause) reached.insert(cause);
  };
  const auto expect = [&](Cause cause, const CycleResult& r) {
    expect_cause(cause, r);
    if (!is_done(cause)) {
      EXPECT_TRUE(r.picks.empty()) << cause_name(cause);
    }
  };
  expect(Cause::kNoResult, bench.cycle().result());
  expect(Cause::kNothingToPage, bench.run(OrderCode::kNextPage));
  expect(Cause::kNothingCaptured, bench.run(OrderCode::kProcess));
  expect(Cause::kDone, bench.run(OrderCode::kDetect));
  Order unknown;
  unknown.code = OrderCode::kNone;
  unknown.refusal = Cause::kCommandUnknown;
  expect(Cause::kCommandUnknown, bench.run(unknown));
  expect(Cause::kRecipeUnknown, bench.run(order_of(OrderCode::kDetect, &Order::recipe, 2)));
  expect(Cause::kRecipeUnknown, bench.run(OrderCode::kSelectRecipe));
  expect(Cause::kPicksMaxTooLarge, bench.run(order_of(OrderCode::kDetect, &Order::picks_max, 17)));
  expect(Cause::kDeadlineTooShort, bench.run(order_of(OrderCode::kDetect, &Order::deadline_ms, 4)));
  bench.run(OrderCode::kFreeRunStart);
  expect(Cause::kFreeRunning, bench.run(OrderCode::kDetect));
  bench.run(OrderCode::kFreeRunStop);

  for (const auto& [error, cause] : kErrors) {
    bench.source.error = error;
    expect(cause, bench.run(OrderCode::kDetect));
    EXPECT_EQ(StationState::kFault, bench.cycle().state());
    EXPECT_EQ(bit(NoPickReason::kNoFrame), bench.cycle().result().no_pick_reasons);
  }
  bench.source.error = ErrorCode::kNone;
  bench.source.wait_for_deadline = true;
  expect(Cause::kDeadlineMissed, bench.run(order_of(OrderCode::kDetect, &Order::deadline_ms, 20)));
  bench.source.wait_for_deadline = false;
  bench.source.bad_camera = true;
  expect(Cause::kDetectionFailed, bench.run(OrderCode::kDetect));
  bench.source.bad_camera = false;

  StationSettings settings = bench.cycle().settings();
  settings.fault_latched = true;
  bench.cycle().set_settings(settings);
  expect(Cause::kInFault, bench.run(OrderCode::kDetect));
  EXPECT_EQ(Cause::kDone, bench.run(OrderCode::kClearFault).cause);
  EXPECT_EQ(Cause::kDone, bench.run(OrderCode::kDetect).cause);
  expect_cause(Cause::kPageUnknown, bench.run(order_of(OrderCode::kPage, &Order::page, 2)));
  EXPECT_EQ(3u, bench.cycle().result().picks.size()) << "a page that is not there changes nothing";

  settings.pose_frame = PoseFrame::kBase;
  settings.mounting = Mounting::kFlange;
  bench.cycle().set_settings(settings);
  expect(Cause::kFlangePoseInvalid, bench.run(OrderCode::kDetect));
  bench.cycle().set_plc_lost(true);
  expect(Cause::kPlcHeartbeatLost, bench.run(OrderCode::kDetect));

  for (const auto& known : modbus::map::kCauseNames) {
    const auto cause = static_cast<Cause>(known.value);
    if (cause == Cause::kCutShort) continue;  // Cycle.TheBestPicksSoFarComeAtTheDeadline
    if (cause == Cause::kBusy) continue;      // the control socket's own: daemon/handshake_test.py
    EXPECT_TRUE(reached.contains(cause)) << known.name;
  }
}

// A clock on which each look takes 0.1 ms: what a deadline cuts off depends on nothing else.
std::int64_t looked_at_ns() {
  static std::atomic<std::int64_t> now{0};
  return now += 100'000;
}

TEST(Cycle, TheBestPicksSoFarComeAtTheDeadline) {
  StationBench bench;
  bench.clock = looked_at_ns;
  bench.config.sensor.frame_deadline_ms = 30000;
  std::set<Cause> seen;
  for (int deadline_ms = 1; deadline_ms < 30000; deadline_ms += 1 + deadline_ms / 3) {
    const CycleResult& r =
        bench.run(order_of(OrderCode::kDetect, &Order::deadline_ms, deadline_ms));
    seen.insert(r.cause);
    if (r.cause == Cause::kCutShort) {
      EXPECT_FALSE(r.picks.empty());
      EXPECT_EQ(StationState::kDone, bench.cycle().state());
    }
    if (r.cause != Cause::kDone) {
      EXPECT_TRUE(r.no_pick_reasons & bit(NoPickReason::kDeadline)) << cause_name(r.cause);
    }
  }
  EXPECT_TRUE(seen.contains(Cause::kCutShort));
  EXPECT_TRUE(seen.contains(Cause::kDeadlineMissed));
  EXPECT_TRUE(seen.contains(Cause::kDone));
}

TEST(Cycle, SaysWhyThereIsNoPick) {
  StationBench bench;
  const CycleResult& none = bench.run(order_of(OrderCode::kDetect, &Order::recipe, 7));
  EXPECT_EQ(Cause::kDone, none.cause);
  EXPECT_TRUE(none.picks.empty());
  EXPECT_TRUE(none.no_pick_reasons & bit(NoPickReason::kBelowScore));
  bench.source.blank = true;
  EXPECT_TRUE(bench.run(OrderCode::kDetect).no_pick_reasons & bit(NoPickReason::kNoMeasurement));
  bench.source.blank = false;
  EXPECT_EQ(bit(NoPickReason::kLimit) & 0xFFFF,
            bench.run(order_of(OrderCode::kDetect, &Order::picks_max, 1)).no_pick_reasons &
                bit(NoPickReason::kLimit));
  EXPECT_EQ(1u, bench.cycle().result().picks.size());
  EXPECT_EQ(3, bench.cycle().result().detections);

  const BracketScene empty = render_brackets(bracket_camera(), {}, 0.1);
  bench.source.scene = &empty;
  const CycleResult& nothing = bench.run(OrderCode::kDetect);
  EXPECT_TRUE(nothing.picks.empty());
  EXPECT_NE(0, nothing.no_pick_reasons);
}

TEST(Cycle, ARecipeIsSelectedOrUsedOnce) {
  StationBench bench;
  EXPECT_EQ(7, bench.run(order_of(OrderCode::kDetect, &Order::recipe, 7)).recipe);
  EXPECT_EQ(1, bench.run(OrderCode::kDetect).recipe);
  bench.run(order_of(OrderCode::kSelectRecipe, &Order::recipe, 7));
  EXPECT_EQ(7, bench.run(OrderCode::kDetect).recipe);
}

TEST(Cycle, FlushForgetsFrameAndPicks) {
  StationBench bench;
  bench.run(OrderCode::kDetect);
  EXPECT_TRUE(bench.run(OrderCode::kFlush).picks.empty());
  EXPECT_EQ(StationState::kIdle, bench.cycle().state());
  EXPECT_EQ(Cause::kNothingCaptured, bench.run(OrderCode::kProcess).cause);
}

TEST(Cycle, PublishesInTheBaseFrameOfAFixedSensor) {
  StationBench bench;
  const Vec3 in_camera = bench.run(OrderCode::kDetect).picks[0].T_ref_pick.t_mm;
  StationSettings settings = bench.cycle().settings();
  settings.pose_frame = PoseFrame::kBase;
  // Looks down from 1 m above the base.
  settings.T_base_cam = pose_of({{0, 0, 1000}, {180, 0, 0}});
  bench.cycle().set_settings(settings);
  const Vec3 in_base = bench.run(OrderCode::kDetect).picks[0].T_ref_pick.t_mm;
  EXPECT_NEAR(in_camera.x(), in_base.x(), 1e-6);
  EXPECT_NEAR(-in_camera.y(), in_base.y(), 1e-6);
  EXPECT_NEAR(1000 - in_camera.z(), in_base.z(), 1e-6);
}

TEST(Cycle, UsesTheFlangePoseOfTheCapture) {
  StationBench bench;
  bench.config.station.pose_frame = PoseFrame::kBase;
  bench.config.station.mounting = Mounting::kFlange;
  bench.config.station.T_flange_cam = {{10, 0, 0}, {0, 0, 0}};
  Order capture;
  capture.code = OrderCode::kCapture;
  capture.has_flange_pose = true;
  capture.T_base_flange.t_mm = Vec3(100, 200, 300);
  ASSERT_EQ(Cause::kDone, bench.run(capture).cause);
  Order process;
  process.code = OrderCode::kProcess;
  process.T_base_flange.t_mm = Vec3(-1, -1, -1);  // the robot has moved on
  const Vec3 in_base = bench.run(process).picks[0].T_ref_pick.t_mm;
  StationBench plain;
  const Vec3 in_camera = plain.run(OrderCode::kDetect).picks[0].T_ref_pick.t_mm;
  EXPECT_LT((in_base - in_camera - Vec3(110, 200, 300)).norm(), 1e-6);
}

TEST(Cycle, AppliesThePickFrame) {
  StationBench plain, moved;
  moved.config.recipes[0].T_obj_pick = {{0, 0, 25}, {0, 0, 90}};
  const Pose part = plain.run(OrderCode::kDetect).picks[0].T_ref_pick;
  const Pose pick = moved.run(OrderCode::kDetect).picks[0].T_ref_pick;
  EXPECT_LT((pick.t_mm - part * Vec3(0, 0, 25)).norm(), 1e-6);
  EXPECT_LT((pick.R.col(0) - part.R.col(1)).norm(), 1e-6);
}

TEST(Ranking, KeepsTheConfiguredOrder) {
  std::vector<Detection> found(3);
  found[0].score = 0.9, found[0].T_cam_obj.t_mm = Vec3(0, 0, 700);
  found[1].score = 0.5, found[1].T_cam_obj.t_mm = Vec3(0, 0, 650);
  found[2].score = 0.7, found[2].T_cam_obj.t_mm = Vec3(500, 0, 690);
  Recipe recipe;
  recipe.models = {0};
  int order[3];
  Pick picks[3];
  const auto scores = [&](Ranking ranking, const Pose& T_ref_cam, bool in_base, int limit) {
    std::vector<double> out;
    const int count = rank_picks(found, recipe, ranking, T_ref_cam, in_base, limit, order, picks);
    for (int i = 0; i < count; ++i) out.push_back(picks[i].score);
    return out;
  };
  using testing::ElementsAre;
  EXPECT_THAT(scores(Ranking::kScore, {}, false, 3), ElementsAre(0.9, 0.7, 0.5));
  EXPECT_THAT(scores(Ranking::kNearCamera, {}, false, 3), ElementsAre(0.5, 0.7, 0.9));
  EXPECT_THAT(scores(Ranking::kHighBase, {}, false, 3), ElementsAre(0.5, 0.7, 0.9));
  // A sensor that looks along the base's x axis sideways: what is far right is high.
  const Pose T_base_cam = pose_of({{0, 0, 0}, {0, -90, 0}});
  EXPECT_THAT(scores(Ranking::kHighBase, T_base_cam, true, 3), ElementsAre(0.7, 0.9, 0.5));
  EXPECT_THAT(scores(Ranking::kScore, {}, false, 2), ElementsAre(0.9, 0.7));
  EXPECT_THAT(scores(Ranking::kScore, {}, false, 0), ElementsAre());
}

// From a detection to the register of its pick.
TEST(Ranking, SaysWhatLooksTheSameAndWhatIsAmbiguous) {
  namespace map = modbus::map;
  std::vector<Detection> found(4);
  for (Detection& d : found) d.visible_fraction = 1;
  found[1].visible_fraction = 0.5;
  found[2].symmetric = true, found[2].pose_probability = 0.9;
  found[3].symmetric = true, found[3].pose_probability = 0.5;
  Recipe recipe;
  recipe.models = {0};
  int order[4];
  Pick picks[4];
  ASSERT_EQ(4, rank_picks(found, recipe, Ranking::kScore, {}, false, 4, order, picks));
  CycleResult result;
  result.picks = picks;
  modbus::AnswerSnapshot answer;
  fill_answer(result, answer);
  const auto bits = [](auto... flags) {
    return static_cast<std::uint16_t>((0 | ... | static_cast<int>(flags)));
  };
  using enum map::PickFlagsBit;
  EXPECT_EQ(answer.page_picks[0].flags, bits());
  EXPECT_EQ(answer.page_picks[1].flags, bits(kPartlyHidden));
  EXPECT_EQ(answer.page_picks[2].flags, bits(kSymmetric));
  EXPECT_EQ(answer.page_picks[3].flags, bits(kSymmetric, kPoseAmbiguous));
}

}  // namespace
}  // namespace binpick::app
