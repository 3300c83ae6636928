// A sensor session on a simulated sensor: losses and returns, many starts, two sensors, and each
// kind of sensor that can be simulated.
#include <gtest/gtest.h>

#include <thread>

#include "gev_bench.hpp"
#include "process_resources.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using app::SensorSession;
using app::SessionParams;

std::unique_ptr<SensorSession> session_on(GevBench& b) {
  SessionParams params;
  params.trigger = b.spec.trigger;
  return std::make_unique<SensorSession>([&b] { return open_camera(b.spec); }, b.pool, params);
}

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

TEST(GevSession, AKilledSensorIsNoticedByTheFrameDeadlineAndUsedAgainWhenItIsBack) {
  GevBench b;
  const auto session = session_on(b);
  ASSERT_TRUE(session->grab(Clock::now() + 10s).ok());
  b.sim->tell("kill");
  auto begun = Clock::now();
  const Result<FrameRef> lost = session->grab(Clock::now() + 60s);
  const double noticed_s = seconds_since(begun);
  ASSERT_FALSE(lost.ok());
  EXPECT_EQ(lost.error().code, ErrorCode::kSensorLost);
  EXPECT_LT(noticed_s, 1.5);
  std::this_thread::sleep_for(1s);
  b.restart();
  begun = Clock::now();
  const Result<FrameRef> back = session->grab(Clock::now() + 60s);
  const double returned_s = seconds_since(begun);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  EXPECT_EQ(session->status().losses, 1u);
  EXPECT_EQ(session->status().opened, 2u);
  std::printf("[ measured ] loss noticed after %.2f s, first good frame %.2f s after the return\n",
              noticed_s, returned_s);
  EXPECT_LT(returned_s, 10);
}

TEST(GevSession, AFrozenSensorComesBackToLife) {
  GevBench b;
  const auto session = session_on(b);
  ASSERT_TRUE(session->grab(Clock::now() + 10s).ok());
  ASSERT_EQ(b.sim->tell("fault frozen 1"), "ok");
  ASSERT_FALSE(session->grab(Clock::now() + 60s).ok());
  std::this_thread::sleep_for(3s);
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  const auto begun = Clock::now();
  const Result<FrameRef> back = session->grab(Clock::now() + 60s);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(b.equals_file(back.value().frame()));
  std::printf("[ measured ] first good frame %.2f s after a frozen sensor's return\n",
              seconds_since(begun));
}

TEST(GevSession, ARefusedConnectionIsTriedAgain) {
  GevBench b({"--fault", "refuse=1"});
  const auto session = session_on(b);
  EXPECT_FALSE(session->grab(Clock::now() + 1s).ok());
  EXPECT_GT(session->status().open_failures, 0u);
  EXPECT_NE(session->status().last_error.find(b.spec.uri), std::string::npos);
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  EXPECT_TRUE(session->grab(Clock::now() + 20s).ok());
}

TEST(GevSession, TheFirstFrameAfterAPauseMayBeLostAndIsAskedForAgain) {
  GevBench b({"--fault", "idle=0.5"});
  const auto session = session_on(b);
  for (int i = 0; i < 3; ++i) {
    std::this_thread::sleep_for(700ms);
    const Result<FrameRef> frame = session->grab(Clock::now() + 20s);
    // Either the frame was lost as a whole, and the sensor opened anew, or the next trigger had it.
    if (frame.ok()) {
      EXPECT_TRUE(b.equals_file(frame.value().frame()));
    }
  }
  ASSERT_EQ(b.sim->tell("clear"), "ok");
  EXPECT_TRUE(session->grab(Clock::now() + 20s).ok());
}

TEST(GevSession, TwoSensorsDoNotDisturbEachOther) {
  GevBench a, b;
  const auto first = session_on(a), second = session_on(b);
  for (int i = 0; i < 10; ++i) {
    const Result<FrameRef> one = first->grab(Clock::now() + 10s);
    const Result<FrameRef> two = second->grab(Clock::now() + 10s);
    ASSERT_TRUE(one.ok() && two.ok());
    EXPECT_TRUE(a.equals_file(one.value().frame()));
    EXPECT_TRUE(b.equals_file(two.value().frame()));
  }
  EXPECT_EQ(first->status().losses + second->status().losses, 0u);
}

// A busy machine loses packets: what counts here is what the attempts leave behind.
bool any_frame(Camera& camera) {
  for (int i = 0; i < 20; ++i) {
    if (camera.trigger().code != ErrorCode::kNone) continue;
    if (camera.wait_frame(Clock::now() + 1s).ok()) return true;
  }
  return false;
}

TEST(GevCameraLife, AHundredStartsLeaveNothingBehind) {
  GevBench b;
  b.spec.packet_size_bytes = 9000;
  const auto camera = open_camera(b.spec);
  const auto cycle = [&] {
    camera->start(b.pool);
    ASSERT_TRUE(any_frame(*camera));
    camera->stop();
  };
  expect_a_hundred_leave_nothing(cycle);
}

TEST(GevCameraLife, TwentyConnectionsLeaveNothingBehind) {
  GevBench b;
  const auto cycle = [&] {
    const auto camera = open_camera(b.spec);
    camera->start(b.pool);
    ASSERT_TRUE(any_frame(*camera));
  };
  for (int i = 0; i < 5; ++i) cycle();
  const int threads = entries_of("/proc/self/task"), descriptors = entries_of("/proc/self/fd");
  for (int i = 0; i < 20; ++i) cycle();
  EXPECT_EQ(threads_at_last(threads), threads);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
}

// Depth that went through another representation: within half a step of it.
void expect_depth_near(const Frame& frame, const LoadedFrame& file, double tolerance_share) {
  ASSERT_EQ(frame.depth_mm.width, file.camera.width);
  std::size_t wrong = 0, measured = 0;
  for (std::size_t i = 0; i < file.depth_mm.size(); ++i) {
    const double got = static_cast<double>(frame.depth_mm.data[i]);
    const double want = static_cast<double>(file.depth_mm[i]);
    measured += got > 0;
    wrong += (got > 0) != (want > 0) || std::abs(got - want) > tolerance_share * want + 0.06;
  }
  EXPECT_GT(measured, file.depth_mm.size() / 4);
  EXPECT_LT(wrong, file.depth_mm.size() / 1000);
}

struct PayloadCase {
  const char* name;
  double tolerance_share;
  SensorProfile profile;
  bool intensity;
};

void PrintTo(const PayloadCase& c, std::ostream* out) {
  *out << c.name;
}

class GevPayloads : public testing::TestWithParam<PayloadCase> {};

TEST_P(GevPayloads, DepthIsThatOfTheFile) {
  GevBench b({"--payload", GetParam().name});
  b.spec.profile = GetParam().profile;
  b.open();
  const Result<FrameRef> frame = b.grab(2);
  ASSERT_TRUE(frame.ok()) << frame.error().where;
  const Frame& f = frame.value().frame();
  expect_depth_near(f, b.files[(f.sequence - 1) % 2], GetParam().tolerance_share);
  EXPECT_EQ(f.intensity.empty(), !GetParam().intensity);
}

SensorProfile with_disparity_chunks() {
  SensorProfile p;
  p.chunks = true;
  p.baseline_unit_mm = 1000;
  return p;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, GevPayloads,
    testing::Values(PayloadCase{"c16", 0, {}, true},
                    PayloadCase{"disparity", 2e-3, with_disparity_chunks(), true},
                    PayloadCase{"abcy16", 0, {}, true}, PayloadCase{"mono16-c32f", 0, {}, true},
                    PayloadCase{"abc32f", 0, {}, true}, PayloadCase{"mono16", 0, {}, true}));

}  // namespace
}  // namespace binpick::drivers
