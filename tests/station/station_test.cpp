// The cycle's thread: orders in, answers out, free running, and not one allocation.
#include "station/station.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <fstream>

#include "core/allocation_count.hpp"
#include "station_bench.hpp"

namespace binpick::app {
namespace {

using namespace std::chrono_literals;

// Counts answers and keeps what each said; has its memory beforehand.
class Listener final : public StationSink {
 public:
  void on_status(const StationStatus&) override {}
  void on_result(const CycleResult& result, const StationStatus& status, const FrameRef&) override {
    const std::lock_guard lock(mutex_);
    ++count_;
    last_ = result;
    last_.picks = {};
    picks_ = result.picks.size();
    status_ = status;
    told_.notify_all();
  }
  bool wait_count(int count) {
    std::unique_lock lock(mutex_);
    return told_.wait_for(lock, 60s, [&] { return count_ >= count; });
  }
  int count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  CycleResult last() const {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  std::size_t picks() const {
    const std::lock_guard lock(mutex_);
    return picks_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable told_;
  int count_ = 0;
  std::size_t picks_ = 0;
  CycleResult last_;
  StationStatus status_;
};

struct RunningStation : StationBench {
  explicit RunningStation(const std::vector<std::uint8_t>& model = bracket_model_bytes())
      : StationBench(model) {}
  void start() {
    make();
    station = std::make_unique<Station>(
        StationParts{*recipes, *detector, source, monotonic_ns, sinks}, config, *arena);
    station->start();
  }
  bool offer(OrderCode code, OrderSource from = OrderSource::kPlc) {
    Order order;
    order.code = code;
    order.source = from;
    order.sequence = ++sequence;
    order.received_ns = monotonic_ns();
    return station->offer(order);
  }

  Listener listener;
  StationSink* sinks[1] = {&listener};
  std::uint32_t sequence = 0;
  std::unique_ptr<Station> station;
};

TEST(Station, AnswersEachOrderOnce) {
  RunningStation s;
  s.start();
  for (int i = 1; i <= 5; ++i) {
    ASSERT_TRUE(s.offer(OrderCode::kDetect));
    ASSERT_TRUE(s.listener.wait_count(i));
    EXPECT_EQ(s.sequence, s.listener.last().order.sequence);
    EXPECT_EQ(3u, s.listener.picks());
  }
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(5, s.listener.count());
}

TEST(Station, RunsFreelyUntilItIsStopped) {
  RunningStation s;
  s.config.station.free_run = true;
  s.start();
  ASSERT_TRUE(s.listener.wait_count(3));
  ASSERT_TRUE(s.offer(OrderCode::kFreeRunStop));
  while (s.station->status().free_running) std::this_thread::sleep_for(1ms);
  while (s.station->status().busy) std::this_thread::sleep_for(1ms);
  const int count = s.listener.count();
  std::this_thread::sleep_for(300ms);
  EXPECT_LE(s.listener.count(), count + 1);
}

TEST(Station, APlcThatIsLostEndsFreeRunning) {
  RunningStation s;
  s.config.station.free_run = true;
  s.start();
  ASSERT_TRUE(s.listener.wait_count(1));
  s.station->set_plc_lost(true);
  while (!s.station->status().plc_lost) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(StationState::kFault, s.station->status().state);
  EXPECT_FALSE(s.station->status().free_running);
  s.station->set_plc_lost(false);
  while (s.station->status().plc_lost) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(StationState::kDone, s.station->status().state);
  const int count = s.listener.count();
  ASSERT_TRUE(s.offer(OrderCode::kDetect));
  ASSERT_TRUE(s.listener.wait_count(count + 1));
  EXPECT_EQ(Cause::kDone, s.listener.last().cause);
}

TEST(Station, TakesOverAReloadBeforeTheNextOrder) {
  RunningStation s;
  s.start();
  Config changed = s.config;
  changed.recipes[0].min_score = 0.999;
  s.station->reload(changed);
  ASSERT_TRUE(s.offer(OrderCode::kDetect));
  ASSERT_TRUE(s.listener.wait_count(1));
  EXPECT_EQ(0u, s.listener.picks());
}

TEST(Station, ProgressGoesOnWhileItWaits) {
  RunningStation s;
  s.start();
  const std::uint64_t before = s.station->progress();
  std::this_thread::sleep_for(1200ms);
  EXPECT_GE(s.station->progress(), before + 2);
}

std::size_t resident_pages() {
  std::ifstream file("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  file >> total >> resident;
  return resident;
}

// Orders of all kinds, faults among them, over thousands of cycles.
TEST(Station, AllocatesNothingOverThousandsOfCycles) {
  if (!allocations_counted()) GTEST_SKIP() << "the sanitizer holds malloc";
  const std::vector<std::uint8_t> model = tiny_model_bytes();
  RunningStation s(model);
  CameraIntrinsics camera = bracket_camera();  // a small window of it, for many cycles
  camera.width = 128;
  camera.height = 96;
  camera.cx = 63.5;
  camera.cy = 47.5;
  const BracketScene window = render_brackets(camera, {bracket_pose(20, 0, 0, Vec3(0, 0, 500))});
  s.source.scene = &window;
  s.config.sensor.width_max = camera.width;
  s.config.sensor.height_max = camera.height;
  s.start();
  constexpr OrderCode kCodes[] = {
      OrderCode::kDetect, OrderCode::kCapture, OrderCode::kProcess, OrderCode::kNextPage,
      OrderCode::kDetect, OrderCode::kFlush,   OrderCode::kProcess, OrderCode::kSelectRecipe};
  const auto run = [&](int orders) {
    for (int i = 0; i < orders; ++i) {
      s.source.error = i % 50 == 49 ? ErrorCode::kSensorLost : ErrorCode::kNone;
      if (!s.offer(kCodes[static_cast<std::size_t>(i) % std::size(kCodes)])) return false;
      if (!s.listener.wait_count(static_cast<int>(s.sequence))) return false;
    }
    return true;
  };
  ASSERT_TRUE(run(16));
  const std::size_t resident_before = resident_pages();
  const long long before = allocation_count();
  ASSERT_TRUE(run(6000));
  const long long made = allocation_count() - before;
  EXPECT_EQ(0, made);
  EXPECT_LE(resident_pages(), resident_before + 16);
  std::printf("[ measured ] %llu cycles, %lld allocations\n",
              static_cast<unsigned long long>(s.listener.last().cycle), made);
}

}  // namespace
}  // namespace binpick::app
