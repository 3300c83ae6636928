// The GenICam driver against a simulated sensor at the wire: what arrives in the frame pool.
#include <gtest/gtest.h>

#include <thread>

#include "gev_bench.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(GevCamera, TriggeredFramesHaveTheBitsOfTheirFiles) {
  for (const int packet_size : {1400, 9000}) {
    GevBench b;
    b.spec.packet_size_bytes = packet_size;
    b.open();
    for (int i = 0; i < 20; ++i) {
      const auto before = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
      const Result<FrameRef> frame = b.grab();
      ASSERT_TRUE(frame.ok()) << frame.error().where;
      const Frame& f = frame.value().frame();
      EXPECT_TRUE(b.equals_file(f)) << f.sequence;
      EXPECT_GE(f.capture_ns, before);
      EXPECT_NE(f.device_ns, 0);
      const CameraIntrinsics& camera = b.files[0].camera;
      EXPECT_EQ(f.camera.fx, camera.fx);
      EXPECT_EQ(f.camera.fy, camera.fy);
      EXPECT_EQ(f.camera.cx, camera.cx);
      EXPECT_EQ(f.camera.cy, camera.cy);
    }
    EXPECT_EQ(b.camera->counters().frames, 20u);
    // A busy machine may lose packets for good, or bring a frame after the next trigger; nothing
    // else may happen.
    EXPECT_EQ(b.camera->counters().dropped_total(),
              b.camera->counters().dropped_count(DropReason::kIncomplete) +
                  b.camera->counters().dropped_count(DropReason::kStale));
  }
}

TEST(GevCamera, FreeRunGivesWholeFramesInOrder) {
  GevBench b({"--fps", "20"});
  b.spec.trigger = TriggerSource::kFreeRun;
  b.open();
  std::uint64_t last = 0;
  for (int i = 0; i < 30; ++i) {
    const Result<FrameRef> frame = b.wait();
    if (!frame.ok()) continue;
    EXPECT_TRUE(b.equals_file(frame.value().frame()));
    EXPECT_GT(frame.value().frame().sequence, last);
    last = frame.value().frame().sequence;
  }
  EXPECT_GE(b.camera->counters().frames, 20u);
}

TEST(GevCamera, FreeRunPassesOverWhatIsNoLongerNew) {
  GevBench b({"--fps", "20"});
  b.spec.trigger = TriggerSource::kFreeRun;
  b.open();
  ASSERT_TRUE(b.wait().ok());
  std::this_thread::sleep_for(500ms);
  ASSERT_TRUE(b.wait().ok());
  EXPECT_GT(b.camera->counters().dropped_count(DropReason::kSuperseded), 0u);
}

// Set by a profile's settings; what the sensor says of its principal point follows.
TEST(GevCamera, ARegionOfInterestIsThatOfTheFile) {
  GevBench b;
  b.spec.profile.settings = {{"OffsetX", "0"},  {"OffsetY", "0"},   {"Width", "640"},
                             {"Height", "480"}, {"OffsetX", "320"}, {"OffsetY", "200"}};
  b.open();
  const Result<FrameRef> result = b.grab();
  ASSERT_TRUE(result.ok());
  const Frame& frame = result.value().frame();
  const LoadedFrame& file = b.files[0];
  ASSERT_EQ(frame.depth_mm.width, 640);
  ASSERT_EQ(frame.depth_mm.height, 480);
  EXPECT_EQ(frame.camera.cx, file.camera.cx - 320);
  EXPECT_EQ(frame.camera.cy, file.camera.cy - 200);
  for (int y = 0; y < 480; ++y) {
    const std::ptrdiff_t at = (200 + y) * std::ptrdiff_t{1280} + 320;
    ASSERT_EQ(std::memcmp(frame.depth_mm.data + y * std::ptrdiff_t{640}, file.depth_mm.data() + at,
                          640 * sizeof(float)),
              0);
    ASSERT_EQ(std::memcmp(frame.intensity.data + y * std::ptrdiff_t{640},
                          file.intensity.data() + at, 640),
              0);
  }
  b.camera->stop();
  b.spec.profile.settings = {{"Width", "1281"}};
  try {
    b.open();
    FAIL() << "no error";
  } catch (const SensorError& e) {
    EXPECT_NE(std::string(e.what()).find("the feature Width cannot be set to 1281"),
              std::string::npos)
        << e.what();
  }
}

TEST(GevCamera, AnEmptyPoolDropsAndCounts) {
  GevBench b({}, 1);
  b.open();
  Result<FrameRef> held = b.grab();
  ASSERT_TRUE(held.ok());
  ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
  const Result<FrameRef> second = b.wait();
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::kSensorFrameDropped);
  EXPECT_EQ(second.error().detail, static_cast<int>(DropReason::kPoolEmpty));
  held = Error{};
  EXPECT_TRUE(b.grab().ok());
  EXPECT_EQ(b.camera->counters().dropped_count(DropReason::kPoolEmpty), 1u);
}

// What the sensor does, and the reasons of which at least one has to be counted.
struct FaultCase {
  const char* fault;
  const char* value;
  std::vector<DropReason> reasons;  // empty: no frame comes at all
  bool harmless = false;            // or every frame is good
};

void PrintTo(const FaultCase& c, std::ostream* out) {
  *out << c.fault << "=" << c.value;
}

class GevFaults : public testing::TestWithParam<FaultCase> {};

TEST_P(GevFaults, NoBadFrameIsAcceptedTheCauseIsCountedAndTheStreamRecovers) {
  GevBench b;
  b.spec.packet_size_bytes = 1400;
  b.open();
  ASSERT_TRUE(b.grab().ok());
  ASSERT_EQ(b.sim->tell(std::string("fault ") + GetParam().fault + " " + GetParam().value), "ok");
  int timeouts = 0;
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
    const Result<FrameRef> frame = b.wait(600ms);
    if (frame.ok()) {
      EXPECT_TRUE(b.equals_file(frame.value().frame())) << "a bad frame was accepted";
    }
    timeouts += !frame.ok() && frame.error().code == ErrorCode::kSensorTimeout;
  }
  const CameraCounters counters = b.camera->counters();
  std::uint64_t caused = static_cast<std::uint64_t>(GetParam().reasons.empty() ? timeouts : 0);
  for (const DropReason reason : GetParam().reasons) caused += counters.dropped_count(reason);
  // Or the packets were asked for again, and nothing was lost.
  const bool repaired = counters.frames == 9 && counters.packets_resent > 0;
  if (GetParam().harmless) {
    EXPECT_EQ(counters.frames, 9u);
  }
  EXPECT_TRUE(caused > 0 || repaired || GetParam().harmless);
  std::printf("[ measured ] %s:", GetParam().fault);
  for (int r = 1; r < kDropReasonCount; ++r) {
    const auto reason = static_cast<DropReason>(r);
    if (counters.dropped_count(reason) > 0)
      std::printf(" %s %d", drop_reason_name(reason),
                  static_cast<int>(counters.dropped_count(reason)));
  }
  std::printf(", timeouts %d, good %d\n", timeouts, static_cast<int>(counters.frames) - 1);
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  const Result<FrameRef> after = b.grab();
  ASSERT_TRUE(after.ok());
  EXPECT_TRUE(b.equals_file(after.value().frame()));
}

INSTANTIATE_TEST_SUITE_P(
    AtTheWire, GevFaults,
    testing::Values(
        FaultCase{"truncate", "0.01", {DropReason::kShortPayload, DropReason::kIncomplete}},
        FaultCase{"wrong-id", "0.01", {DropReason::kIncomplete}},
        FaultCase{"wrong-size", "0.01", {}, true},
        FaultCase{"lying-offset", "1", {DropReason::kPartBounds, DropReason::kShortPayload}},
        FaultCase{"lying-size",
                  "1",
                  {DropReason::kPartBounds, DropReason::kShortPayload, DropReason::kIncomplete}},
        FaultCase{"lying-width", "1", {DropReason::kSize, DropReason::kPartBounds}},
        FaultCase{"lying-height", "1", {DropReason::kSize, DropReason::kPartBounds}},
        FaultCase{"stop-stream", "1", {}}));

struct LossCase {
  int packet_size;
  const char* loss;
};

void PrintTo(const LossCase& c, std::ostream* out) {
  *out << c.loss << " at " << c.packet_size;
}

class GevLoss : public testing::TestWithParam<LossCase> {};

// Leader and trailer too, and now and then both of them, or what is sent again.
TEST_P(GevLoss, LostPacketsAreSentAgainAndEveryFrameIsWhole) {
  GevBench b;
  b.spec.packet_size_bytes = GetParam().packet_size;
  b.spec.frame_retention_ms = 3000;  // on a busy machine everything takes longer
  b.open();
  ASSERT_EQ(b.sim->tell(std::string("fault loss ") + GetParam().loss), "ok");
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
    const Result<FrameRef> frame = b.wait(std::chrono::seconds(20));
    ASSERT_TRUE(frame.ok()) << "frame " << i << " was not repaired";
    EXPECT_TRUE(b.equals_file(frame.value().frame())) << "a bad frame was accepted";
  }
  const CameraCounters counters = b.camera->counters();
  EXPECT_EQ(counters.dropped_total() + counters.frames_missed, 0u);
  EXPECT_GT(counters.packets_resent, 0u);
}

INSTANTIATE_TEST_SUITE_P(OfPackets, GevLoss,
                         testing::Values(LossCase{1400, "0.002"}, LossCase{1400, "0.05"},
                                         LossCase{9000, "0.002"}, LossCase{9000, "0.05"},
                                         LossCase{9000, "0.1"}));

TEST(GevCamera, DisturbedOrderAndDuplicatesDoNoHarm) {
  GevBench b;
  b.open();
  ASSERT_EQ(b.sim->tell("fault reorder 0.05"), "ok");
  ASSERT_EQ(b.sim->tell("fault duplicate 0.05"), "ok");
  for (int i = 0; i < 10; ++i) {
    const Result<FrameRef> frame = b.grab();
    ASSERT_TRUE(frame.ok());
    EXPECT_TRUE(b.equals_file(frame.value().frame()));
  }
}

TEST(GevCamera, AnswersErrorsThatNameTheSensor) {
  CameraSpec spec;
  for (const char* uri : {"gev://127.255.1.1", "gev://serial/none-such", "u3v://serial/none-such",
                          "u3v://1", "camera://x"}) {
    spec.uri = uri;
    try {
      open_camera(spec);
      FAIL() << uri;
    } catch (const SensorError& e) {
      EXPECT_NE(std::string(e.what()).find(uri), std::string::npos) << e.what();
    }
  }
}

TEST(GevCamera, WhatASensorLacksIsListedAtItsStart) {
  GevBench b;
  b.spec.profile.optional_settings = {{"NoSuchFeature", "1"}};
  b.spec.profile.components = {{"Range", true, false, ""}, {"Thermal", true, true, ""}};
  b.open();
  EXPECT_EQ(b.camera->missing_features(),
            (std::vector<std::string>{"NoSuchFeature", "ComponentSelector Thermal"}));
}

TEST(GevCamera, MissingFeaturesAndTooLargeFramesAreNamed) {
  const auto start_error = [](GevBench& b) -> std::string {
    try {
      b.open();
    } catch (const SensorError& e) {
      return e.what();
    }
    return "";
  };
  GevBench b;
  b.spec.profile.focal_length.feature = "Scan3dNoSuchLength";
  EXPECT_EQ(start_error(b), b.spec.uri + ": the sensor has no feature Scan3dNoSuchLength");
  b.camera.reset();
  b.spec.profile = {};
  b.spec.profile.scale.value = 0;
  EXPECT_EQ(start_error(b), b.spec.uri +
                                ": the feature Scan3dCoordinateScale of axis C is 0, "
                                "which cannot be used");
  b.camera.reset();
  b.spec.profile = {};
  b.spec.profile.components = {{"Thermal", true, false, ""}};
  EXPECT_EQ(start_error(b), b.spec.uri + ": the feature ComponentSelector has no entry Thermal");
  b.camera.reset();
  b.spec.profile = {};
  Arena arena(FramePool::footprint({1, 640, 480}));
  FramePool small({1, 640, 480}, arena);
  const auto camera = open_camera(b.spec);
  EXPECT_THROW(camera->start(small), SensorError);
}

}  // namespace
}  // namespace binpick::drivers
