// The GenICam driver and a sensor session on a simulated USB3 Vision sensor: faults, losses and
// returns, through the real Aravis and libusb.
#include <gtest/gtest.h>
#include <time.h>

#include <atomic>
#include <thread>

#include "process_resources.hpp"
#include "sensor/live_sensor.hpp"
#include "tiny_scene.hpp"
#include "u3v_bench.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using app::LiveSensor;
using app::SessionParams;

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

std::int64_t ns_of(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

// What the sensor does, and the reasons of which at least one has to be counted.
struct FaultCase {
  const char* fault;
  std::vector<DropReason> reasons;  // empty: no frame comes at all
  bool harmless = false;            // every frame is good
};

void PrintTo(const FaultCase& c, std::ostream* out) {
  *out << c.fault;
}

class U3vFaults : public testing::TestWithParam<FaultCase> {};

TEST_P(U3vFaults, NoBadFrameIsAcceptedTheCauseIsCountedAndTheSessionRecovers) {
  U3vBench b;
  LiveSensor sensor(b.spec, b.pool, {});
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  b.tell(std::string("fault ") + GetParam().fault + " 1");
  int good = 0, lost = 0, dropped = 0;
  for (int i = 0; i < 3; ++i) {
    const auto asked_ns = ns_of(Clock::now());
    const Result<FrameRef> frame = sensor.session().grab(Clock::now() + 2s);
    if (frame.ok()) {
      // A stall ends when the host clears it.
      EXPECT_TRUE(b.equals_file(frame.value().frame())) << "a bad frame was accepted";
      EXPECT_GE(frame.value().frame().capture_ns, asked_ns) << "a stale frame was accepted";
      ++good;
      continue;
    }
    lost += frame.error().code == ErrorCode::kSensorLost;
    dropped += frame.error().code == ErrorCode::kSensorFrameDropped;
  }
  const app::SessionStatus status = sensor.session().status();
  std::uint64_t caused = GetParam().reasons.empty() ? status.losses : 0;
  for (const DropReason reason : GetParam().reasons) caused += status.camera.dropped_count(reason);
  if (GetParam().harmless) {
    EXPECT_EQ(good, 3);
  } else {
    EXPECT_GT(caused, 0u);
  }
  std::printf("[ measured ] %s: good %d, dropped %d, lost %d, losses %d;", GetParam().fault, good,
              dropped, lost, static_cast<int>(status.losses));
  for (int r = 1; r < kDropReasonCount; ++r) {
    const auto reason = static_cast<DropReason>(r);
    if (status.camera.dropped_count(reason) > 0)
      std::printf(" %s %d", drop_reason_name(reason),
                  static_cast<int>(status.camera.dropped_count(reason)));
  }
  std::printf("\n");
  b.tell("clear");
  const auto cleared = Clock::now();
  Result<FrameRef> after = Error{ErrorCode::kSensorTimeout, 0, "never"};
  while (!after.ok() && seconds_since(cleared) < 20)
    after = sensor.session().grab(Clock::now() + 2s);
  ASSERT_TRUE(after.ok());
  EXPECT_TRUE(b.equals_file(after.value().frame()));
  EXPECT_GE(after.value().frame().capture_ns, ns_of(cleared));
}

INSTANTIATE_TEST_SUITE_P(
    AtTheBus, U3vFaults,
    testing::Values(
        // No frame ends until the stream is started anew.
        FaultCase{"short-payload", {DropReason::kShortPayload}},
        FaultCase{"wrong-trailer", {DropReason::kIncomplete}},
        // Aravis passes over the trailer's status: a frame is judged by its bytes.
        FaultCase{"trailer-status", {}, true},
        FaultCase{"lying-width", {DropReason::kSize, DropReason::kShortPayload}},
        FaultCase{"lying-height", {DropReason::kSize, DropReason::kShortPayload}},
        FaultCase{"stall", {DropReason::kIncomplete}}, FaultCase{"stop-stream", {}}));

// Nobody but the driver can end it: the sensor waits for the host to clear the halt.
TEST(U3vSession, AStalledStreamIsStartedAnew) {
  U3vBench b;
  LiveSensor sensor(b.spec, b.pool, {});
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  b.tell("fault stall 1");
  const auto begun = Clock::now();
  Result<FrameRef> back = sensor.session().grab(Clock::now() + 20s);
  while (!back.ok() && seconds_since(begun) < 20) back = sensor.session().grab(Clock::now() + 20s);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  EXPECT_GE(sensor.session().status().losses, 1u);
  EXPECT_GT(sensor.session().status().camera.dropped_count(DropReason::kIncomplete), 0u);
  std::printf("[ measured ] first good frame %.2f s after a stall\n", seconds_since(begun));
}

TEST(U3vSession, AFreeRunThatFellOutOfStepIsStartedAnew) {
  U3vBench b({"--fps", "20"});
  b.spec.trigger = TriggerSource::kFreeRun;
  LiveSensor sensor(b.spec, b.pool, {});
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  b.tell("fault short-payload 1");
  // Long enough for one of them.
  std::this_thread::sleep_for(300ms);
  b.tell("clear");
  const auto cleared = Clock::now();
  Result<FrameRef> back = sensor.session().grab(Clock::now() + 20s);
  while (!back.ok() && seconds_since(cleared) < 20)
    back = sensor.session().grab(Clock::now() + 20s);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  EXPECT_GT(sensor.session().status().camera.dropped_count(DropReason::kIncomplete), 0u);
  std::printf("[ measured ] first good frame %.2f s after short ones\n", seconds_since(cleared));
}

TEST(U3vSession, AnUnpluggedSensorIsNoticedAndUsedAgainWhenItIsBack) {
  U3vBench b;
  SessionParams params;
  // Long, so that it is the arrival that ends it.
  params.backoff_first = params.backoff_max = 60s;
  LiveSensor sensor(b.spec, b.pool, params);
  EXPECT_EQ(sensor.watch_fault(), "");
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  b.tell("unplug");
  auto begun = Clock::now();
  const Result<FrameRef> lost = sensor.session().grab(Clock::now() + 30s);
  const double noticed_s = seconds_since(begun);
  ASSERT_FALSE(lost.ok());
  EXPECT_EQ(lost.error().code, ErrorCode::kSensorLost);
  // Until the worker has failed once, and sleeps.
  for (int i = 0; i < 200 && sensor.session().status().open_failures == 0; ++i)
    std::this_thread::sleep_for(50ms);
  EXPECT_EQ(sensor.session().status().open_failures, 1u);
  b.tell("plug");
  begun = Clock::now();
  const Result<FrameRef> back = sensor.session().grab(Clock::now() + 30s);
  const double returned_s = seconds_since(begun);
  ASSERT_TRUE(back.ok()) << sensor.session().status().last_error;
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  EXPECT_GE(back.value().frame().capture_ns, ns_of(begun));
  EXPECT_EQ(sensor.session().status().losses, 1u);
  EXPECT_EQ(sensor.session().status().opened, 2u);
  std::printf(
      "[ measured ] unplugging noticed after %.2f s, first good frame %.2f s after the "
      "return\n",
      noticed_s, returned_s);
  EXPECT_LT(noticed_s, 5);
  EXPECT_LT(returned_s, 10);
}

// To a program that has it open.
TEST(U3vSession, TheSimulatorsEndIsAPulledCable) {
  U3vBench b;
  LiveSensor sensor(b.spec, b.pool, {});
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  const auto begun = Clock::now();
  EXPECT_EQ(b.sim->quit(), 0);
  std::printf("[ measured ] it ended after %.2f s\n", seconds_since(begun));
  EXPECT_EQ(sensor.session().grab(Clock::now() + 1s).error().code, ErrorCode::kSensorLost);
  EXPECT_EQ(sensor.session().status().losses, 1u);
}

// Every access on it takes seconds: the port is reset while the worker is still stuck in one.
TEST(U3vSession, ASensorThatHangsUntilItsPortIsResetIsRecovered) {
  U3vBench b;
  std::atomic<std::int64_t> reset_ns{0};
  SessionParams params = app::with_port_reset(b.spec.uri, {});
  params.recover = [reset = params.recover, &reset_ns](bool in_use) {
    reset(in_use);
    reset_ns = ns_of(Clock::now());
  };
  LiveSensor sensor(b.spec, b.pool, params);
  ASSERT_TRUE(sensor.session().grab(Clock::now() + 20s).ok());
  b.tell("fault hung 1");
  const auto hung = Clock::now();
  ASSERT_FALSE(sensor.session().grab(Clock::now() + 60s).ok());
  const double noticed_s = seconds_since(hung);
  const Result<FrameRef> back = sensor.session().grab(Clock::now() + 60s);
  const double after_hang_s = seconds_since(hung);
  const double after_reset_s = 1e-9 * static_cast<double>(ns_of(Clock::now()) - reset_ns);
  const app::SessionStatus status = sensor.session().status();
  ASSERT_TRUE(back.ok()) << status.last_error << "; " << status.last_recovery_error;
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  EXPECT_EQ(status.recoveries, 1u) << status.last_recovery_error;
  EXPECT_EQ(b.sim->counter("resets"), 1);
  EXPECT_EQ(status.losses, 1u);
  std::printf(
      "[ measured ] hung: noticed after %.2f s, first good frame %.2f s after it hung, %.2f s "
      "after "
      "its port was reset\n",
      noticed_s, after_hang_s, after_reset_s);
  EXPECT_LT(after_reset_s, 10);
}

TEST(U3vCamera, TwentyFramesASecondArriveWholeAndInOrder) {
  U3vBench b({"--fps", "20"});
  b.spec.trigger = TriggerSource::kFreeRun;
  b.open();
  std::uint64_t last = 0;
  const auto begun = Clock::now();
  int good = 0;
  while (good < 80 && seconds_since(begun) < 40) {
    const Result<FrameRef> frame = b.camera->wait_frame(Clock::now() + 3s);
    if (!frame.ok()) continue;
    ++good;
    EXPECT_TRUE(b.equals_file(frame.value().frame()));
    EXPECT_GT(frame.value().frame().sequence, last);
    last = frame.value().frame().sequence;
  }
  const double took_s = seconds_since(begun);
  const CameraCounters counters = b.camera->counters();
  EXPECT_EQ(good, 80);
  EXPECT_EQ(counters.dropped_total(), 0u);
  std::printf("[ measured ] %d frames in %.2f s: %.1f frames/s; missed %d, superseded %d\n", good,
              took_s, good / took_s, static_cast<int>(counters.frames_missed),
              static_cast<int>(counters.dropped_count(DropReason::kSuperseded)));
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Small frames: all buffers fit under way at once.
TEST(U3vCamera, WaitsForSmallFramesWithoutFillingACore) {
  const TinyScene scene(2);
  U3vBench b({}, scene.path());
  b.open();
  ASSERT_EQ(b.camera->trigger().code, ErrorCode::kNone);
  ASSERT_TRUE(b.camera->wait_frame(Clock::now() + 10s).ok());
  const double before_s = processor_seconds();
  const auto begun = Clock::now();
  EXPECT_FALSE(b.camera->wait_frame(begun + 2s).ok());
  const double share = (processor_seconds() - before_s) / seconds_since(begun);
  std::printf("[ measured ] %.0f %% of a core while waiting\n", 100 * share);
  EXPECT_LT(share, 0.5);
}

TEST(U3vCameraLife, AHundredStartsLeaveNothingBehind) {
  U3vBench b;
  const auto camera = open_camera(b.spec);
  const auto cycle = [&] {
    camera->start(b.pool);
    ASSERT_EQ(camera->trigger().code, ErrorCode::kNone);
    ASSERT_TRUE(camera->wait_frame(Clock::now() + 10s).ok());
    camera->stop();
  };
  expect_a_hundred_leave_nothing(cycle);
}

TEST(U3vCameraLife, TwentyConnectionsLeaveNothingBehind) {
  U3vBench b;
  const auto cycle = [&] {
    const auto camera = open_camera(b.spec);
    camera->start(b.pool);
    ASSERT_EQ(camera->trigger().code, ErrorCode::kNone);
    ASSERT_TRUE(camera->wait_frame(Clock::now() + 10s).ok());
  };
  for (int i = 0; i < 5; ++i) cycle();
  const int threads = entries_of("/proc/self/task"), descriptors = entries_of("/proc/self/fd");
  for (int i = 0; i < 20; ++i) cycle();
  EXPECT_EQ(threads_at_last(threads), threads);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
}

}  // namespace
}  // namespace binpick::drivers
