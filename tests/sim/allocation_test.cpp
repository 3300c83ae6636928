// Between start and stop the project's code takes nothing from the heap: not on the thread that
// grabs, and with a live sensor on no thread at all. What Aravis and GLib take is printed.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "core/allocation_count.hpp"
#include "gev_bench.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class Allocations : public testing::Test {
 protected:
  void SetUp() override {
    if (!allocations_counted()) GTEST_SKIP() << "a sanitizer holds malloc";
  }
};

TEST_F(Allocations, AreSeenAndToldApart) {
  const AllocationCounts before = allocations_of_this_thread();
  auto number = std::make_unique<int>(1);
  std::vector<int> numbers(static_cast<std::size_t>(*number) + 10);
  EXPECT_GE(allocations_of_this_thread().own, before.own + 2);
  const AllocationCounts mine = allocations_of_this_thread();
  std::unique_ptr<char, decltype(&std::free)> text(realpath("/tmp", nullptr), &std::free);
  EXPECT_EQ(allocations_of_this_thread().own, mine.own);
  EXPECT_GT(allocations_of_this_thread().others, mine.others);
  EXPECT_EQ(numbers.back(), 0);
}

struct LiveCase {
  const char* payload;
  TriggerSource trigger;
  bool chunks;
};

void PrintTo(const LiveCase& c, std::ostream* out) {
  *out << c.payload << (c.trigger == TriggerSource::kFreeRun ? ", free run" : ", triggered")
       << (c.chunks ? ", chunks" : "");
}

class AllocationsOfALiveSensor : public Allocations,
                                 public testing::WithParamInterface<LiveCase> {};

TEST_P(AllocationsOfALiveSensor, AreNoneOfOurOwn) {
  GevBench b({"--payload", GetParam().payload, "--fps", "20"});
  b.spec.trigger = GetParam().trigger;
  if (GetParam().chunks) {
    b.spec.profile.chunks = true;
    b.spec.profile.baseline_unit_mm = 1000;
  }
  b.open();
  int good = 0;
  const auto grab = [&] {
    if (b.spec.trigger == TriggerSource::kSoftware && b.camera->trigger().code != ErrorCode::kNone)
      return;
    const Result<FrameRef> frame = b.wait(1s);
    good += frame.ok();
  };
  for (int i = 0; i < 5; ++i) grab();  // tables made by the first frame are made at start
  good = 0;
  const AllocationCounts before = allocations_of_this_thread(),
                         all_before = allocations_of_all_threads();
  for (int i = 0; i < 30; ++i) grab();
  const AllocationCounts after = allocations_of_this_thread(),
                         all_after = allocations_of_all_threads();
  EXPECT_EQ(after.own, before.own);
  EXPECT_EQ(all_after.own, all_before.own);
  ASSERT_GT(good, 10);
  std::printf(
      "[ measured ] of Aravis and GLib for each of 30 frames: %.1f on the thread that "
      "grabs, %.1f on all\n",
      static_cast<double>(after.others - before.others) / 30,
      static_cast<double>(all_after.others - all_before.others) / 30);
}

INSTANTIATE_TEST_SUITE_P(Kinds, AllocationsOfALiveSensor,
                         testing::Values(LiveCase{"c16", TriggerSource::kSoftware, false},
                                         LiveCase{"c16", TriggerSource::kFreeRun, false},
                                         LiveCase{"disparity", TriggerSource::kSoftware, true},
                                         LiveCase{"abcy16", TriggerSource::kSoftware, false},
                                         LiveCase{"abc32f", TriggerSource::kSoftware, false},
                                         LiveCase{"mono16-c32f", TriggerSource::kSoftware, false}));

TEST_F(Allocations, OfASessionAreNoneOfOurOwn) {
  GevBench b;
  app::SensorSession session([&b] { return open_camera(b.spec); }, b.pool, {});
  ASSERT_TRUE(session.wait_ready(Clock::now() + 20s));
  for (int i = 0; i < 5; ++i) (void)session.grab(Clock::now() + 5s);
  ASSERT_TRUE(session.wait_ready(Clock::now() + 20s));
  const std::uint64_t opened = session.status().opened;
  int good = 0;
  const AllocationCounts before = allocations_of_all_threads();
  for (int i = 0; i < 20; ++i) good += session.grab(Clock::now() + 5s).ok();
  const AllocationCounts after = allocations_of_all_threads();
  if (session.status().opened != opened) GTEST_SKIP() << "the busy machine lost the sensor";
  EXPECT_EQ(after.own, before.own);
  EXPECT_GT(good, 10);
}

TEST_F(Allocations, OfARecordingsGrabAreNone) {
  const std::vector<LoadedFrame> none;
  Arena arena(FramePool::footprint({2, 1280, 1024}));
  FramePool pool({2, 1280, 1024}, arena);
  for (const TriggerSource trigger : {TriggerSource::kSoftware, TriggerSource::kFreeRun}) {
    CameraSpec spec;
    spec.uri = std::string("replay:") + kSampleBin;
    spec.trigger = trigger;
    spec.loop = true;
    spec.paced = false;
    const auto camera = open_camera(spec);
    camera->start(pool);
    int good = 0;
    const AllocationCounts before = allocations_of_this_thread();
    for (int i = 0; i < 10; ++i) {
      if (trigger == TriggerSource::kSoftware) (void)camera->trigger();
      good += camera->wait_frame(Clock::now() + 20s).ok();
    }
    const AllocationCounts after = allocations_of_this_thread();
    EXPECT_EQ(after.own, before.own);
    EXPECT_EQ(after.others, before.others);
    EXPECT_EQ(good, 10);
  }
}

}  // namespace
}  // namespace binpick::drivers
