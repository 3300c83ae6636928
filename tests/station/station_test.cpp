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
  StationStatus status() const {
    const std::lock_guard lock(mutex_);
    return status_;
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

// Of those that wait only the newest is taken; it says that there was another one.
TEST(Station, TellsThatAnOrderTookThePlaceOfAnother) {
  RunningStation s;
  s.config.sensor.frame_deadline_ms = 2000;
  s.source.wait_for_deadline = true;  // the first order takes so long
  s.start();
  ASSERT_TRUE(s.offer(OrderCode::kDetect));
  while (!s.station->status().busy) std::this_thread::sleep_for(1ms);
  ASSERT_TRUE(s.offer(OrderCode::kDetect));
  ASSERT_TRUE(s.offer(OrderCode::kNextPage));
  ASSERT_TRUE(s.listener.wait_count(2));
  EXPECT_EQ(3u, s.listener.last().order.sequence);
  EXPECT_TRUE(s.listener.status().order_replaced_one);
  EXPECT_EQ(1u, s.listener.status().orders_replaced);
  ASSERT_TRUE(s.offer(OrderCode::kNone));
  ASSERT_TRUE(s.listener.wait_count(3));
  EXPECT_FALSE(s.listener.status().order_replaced_one);
  EXPECT_EQ(1u, s.listener.status().orders_replaced);
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
  changed.recipes[0].min_score = 1;
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

// Gives the station its next order with each answer, on the cycle's own thread: so a run takes what
// its cycles take, whatever else the machine has to do.
class Feeder final : public StationSink {
 public:
  explicit Feeder(ScriptedSource& source) : source_(source) {}

  // Orders of all kinds on the scene and on blank frames, which take no time; every fiftieth finds
  // the sensor lost. False: not in time.
  bool run(Station& station, int orders) {
    std::unique_lock lock(mutex_);
    station_ = &station;
    left_ = orders;
    give_next();
    return done_.wait_for(lock, 300s, [&] { return left_ == 0; });
  }
  void on_status(const StationStatus&) override {}
  void on_result(const CycleResult& result, const StationStatus&, const FrameRef&) override {
    const std::lock_guard lock(mutex_);
    cycles_ = result.cycle;
    with_picks_ += result.picks.empty() ? 0 : 1;
    faults_ += is_fault(result.cause) ? 1 : 0;
    if (--left_ > 0) {
      give_next();
    } else {
      done_.notify_all();
    }
  }
  std::uint64_t cycles() const { return cycles_; }
  int with_picks() const { return with_picks_; }
  int faults() const { return faults_; }

 private:
  void give_next() {
    constexpr OrderCode kCodes[] = {
        OrderCode::kDetect, OrderCode::kCapture, OrderCode::kProcess, OrderCode::kNextPage,
        OrderCode::kDetect, OrderCode::kFlush,   OrderCode::kProcess, OrderCode::kSelectRecipe};
    source_.blank = sequence_ / std::size(kCodes) % 10 != 0;
    source_.error = sequence_ % 50 == 48 ? ErrorCode::kSensorLost : ErrorCode::kNone;
    Order order;
    order.code = kCodes[sequence_ % std::size(kCodes)];
    if (order.code == OrderCode::kSelectRecipe) order.recipe = sequence_ % 16 < 8 ? 7 : 1;
    order.sequence = ++sequence_;
    order.received_ns = monotonic_ns();
    EXPECT_TRUE(station_->offer(order));
  }

  ScriptedSource& source_;
  Station* station_ = nullptr;
  std::mutex mutex_;
  std::condition_variable done_;
  int left_ = 0, with_picks_ = 0, faults_ = 0;
  std::uint64_t cycles_ = 0;
  std::uint32_t sequence_ = 0;
};

// Orders of all kinds, faults among them, over thousands of cycles.
TEST(Station, AllocatesNothingOverThousandsOfCycles) {
  if (!allocations_counted()) GTEST_SKIP() << "the sanitizer holds malloc";
  RunningStation s;
  CameraIntrinsics camera = bracket_camera();  // a small image of one bracket, for many cycles
  camera.width = 96;
  camera.height = 80;
  camera.fx /= 2;
  camera.fy /= 2;
  camera.cx = 47.5;
  camera.cy = 39.5;
  const BracketScene window = render_brackets(camera, {bracket_pose(20, 0, 0, Vec3(0, 0, 500))});
  s.source.scene = &window;
  s.config.sensor.width_max = camera.width;
  s.config.sensor.height_max = camera.height;
  Feeder feeder(s.source);
  s.sinks[0] = &feeder;
  s.start();
  ASSERT_TRUE(feeder.run(*s.station, 100));
  const std::size_t resident_before = resident_pages();
  const long long before = allocation_count();
  ASSERT_TRUE(feeder.run(*s.station, 6000));
  const long long made = allocation_count() - before;
  EXPECT_EQ(0, made);
  EXPECT_LE(resident_pages(), resident_before + 16);
  EXPECT_GT(feeder.cycles(), 2900u);
  EXPECT_GT(feeder.with_picks(), 150);
  EXPECT_GT(feeder.faults(), 50);
  s.station.reset();  // before its sink
  std::printf("[ measured ] %llu cycles, %lld allocations\n",
              static_cast<unsigned long long>(feeder.cycles()), made);
}

}  // namespace
}  // namespace binpick::app
