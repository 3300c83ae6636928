#include "sensor/sensor_session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace binpick::app {
namespace {

using namespace std::chrono_literals;
using drivers::DropReason;
using drivers::TriggerSource;
using Clock = std::chrono::steady_clock;

// What the sensor at the other end does; outlives every connection.
struct Script {
  std::atomic<bool> absent{false};     // opening fails
  std::atomic<bool> silent{false};     // no frame comes
  std::atomic<bool> dead_link{false};  // every access blocks, as Aravis' do, until this ends
  std::atomic<bool> control_lost{false};
  std::atomic<int> drops{0};  // so many frames are dropped first
  std::atomic<bool> ended{false};
  std::atomic<int> opened{0}, alive{0}, recovered{0}, recovered_in_use{0};
  std::atomic<std::uint64_t> sequence{0};

  void access() const;
};
constexpr auto kBlocked = 1500ms;

void Script::access() const {
  const auto until = Clock::now() + kBlocked;
  while (dead_link && Clock::now() < until) std::this_thread::sleep_for(5ms);
}

class ScriptedCamera final : public drivers::Camera {
 public:
  explicit ScriptedCamera(Script& script, bool triggered) : script_(script), triggered_(triggered) {
    if (script_.absent) throw drivers::SensorError("gev://test: absent");
    ++script_.opened;
    ++script_.alive;
  }
  ~ScriptedCamera() override { --script_.alive; }

  void start(FramePool& pool) override { pool_ = &pool; }
  Result<FrameRef> wait_frame(TimePoint deadline) override {
    if (script_.control_lost) return Error{ErrorCode::kSensorLost, 0, "test"};
    if (script_.ended) return Error{ErrorCode::kSensorEnd, 0, "test"};
    if (script_.silent || (triggered_ && !wanted_)) {
      std::this_thread::sleep_until(deadline);
      return Error{ErrorCode::kSensorTimeout, 0, "test"};
    }
    if (!triggered_) std::this_thread::sleep_for(5ms);
    wanted_ = false;
    if (script_.drops > 0) {
      --script_.drops;
      return Error{ErrorCode::kSensorFrameDropped, static_cast<int>(DropReason::kIncomplete), ""};
    }
    FrameRef ref = pool_->try_take();
    if (!ref)
      return Error{ErrorCode::kSensorFrameDropped, static_cast<int>(DropReason::kPoolEmpty), ""};
    ref.slot().frame.sequence = ++script_.sequence;
    ref.slot().frame.capture_ns = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
    ++counters_.frames;
    return ref;
  }
  Error trigger() override {
    if (script_.dead_link) {
      script_.access();
      return {ErrorCode::kSensorRefused, 0, "test"};
    }
    wanted_ = true;
    return {};
  }
  void stop() override { script_.access(); }
  drivers::CameraCounters counters() const override { return counters_; }

 private:
  Script& script_;
  const bool triggered_;
  bool wanted_ = false;
  FramePool* pool_ = nullptr;
  drivers::CameraCounters counters_;
};

struct Station {
  explicit Station(TriggerSource trigger = TriggerSource::kSoftware)
      : arena(FramePool::footprint({3, 8, 8})), pool({3, 8, 8}, arena) {
    params.trigger = trigger;
    params.frame_deadline = 200ms;
    params.backoff_first = 5ms;
    params.backoff_max = 20ms;
    params.failures_before_recovery = 3;
    params.recover = [this](bool in_use) {
      ++script.recovered;
      script.recovered_in_use += in_use;
    };
  }
  void start() {
    const bool triggered = params.trigger == TriggerSource::kSoftware;
    session = std::make_unique<SensorSession>(
        [this, triggered] { return std::make_unique<ScriptedCamera>(script, triggered); }, pool,
        params);
  }
  Result<FrameRef> grab(std::chrono::milliseconds within = 5000ms) {
    return session->grab(Clock::now() + within);
  }
  ErrorCode grab_error(std::chrono::milliseconds within) {
    const Result<FrameRef> result = grab(within);
    return result.ok() ? ErrorCode::kNone : result.error().code;
  }

  Script script;
  Arena arena;
  FramePool pool;
  SessionParams params;
  std::unique_ptr<SensorSession> session;
};

TEST(SensorSession, GivesATriggeredFrame) {
  Station s;
  s.start();
  for (std::uint64_t i = 1; i <= 20; ++i) {
    const Result<FrameRef> frame = s.grab();
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame.value().frame().sequence, i);
  }
  const SessionStatus status = s.session->status();
  EXPECT_EQ(status.state, SessionState::kReady);
  EXPECT_EQ(status.opened, 1u);
  EXPECT_EQ(status.losses, 0u);
  EXPECT_EQ(status.camera.frames, 20u);
  EXPECT_EQ(s.pool.free_count(), 3);
}

TEST(SensorSession, TriggersAgainWhenAFrameWasDropped) {
  Station s;
  s.script.drops = 3;
  s.start();
  EXPECT_TRUE(s.grab().ok());
  EXPECT_EQ(s.session->status().retriggers, 3u);
  EXPECT_EQ(s.session->status().losses, 0u);
}

TEST(SensorSession, AnExhaustedPoolIsNoLoss) {
  Station s;
  s.params.frame_deadline = 1s;  // a busy machine may let the worker wait for a good part of it
  s.start();
  std::vector<FrameRef> held;
  for (int i = 0; i < 3; ++i) held.push_back(s.pool.try_take());
  EXPECT_EQ(s.grab_error(5000ms), ErrorCode::kSensorFrameDropped);
  EXPECT_EQ(s.session->status().losses, 0u);
  held.clear();
  EXPECT_TRUE(s.grab().ok());
}

TEST(SensorSession, OpensAnAbsentSensorAgainAndAgainAndRecoversInBetween) {
  Station s;
  s.script.absent = true;
  s.start();
  EXPECT_EQ(s.grab_error(150ms), ErrorCode::kSensorLost);
  SessionStatus status = s.session->status();
  EXPECT_EQ(status.state, SessionState::kConnecting);
  EXPECT_GT(status.open_failures, 3u);
  EXPECT_EQ(status.last_error, "gev://test: absent");
  EXPECT_GE(s.script.recovered, 1);
  s.script.absent = false;
  EXPECT_TRUE(s.grab().ok());
}

TEST(SensorSession, SilenceIsALossAndTheSensorIsOpenedAnew) {
  Station s;
  s.start();
  ASSERT_TRUE(s.grab().ok());
  s.script.silent = true;
  const auto begun = Clock::now();
  EXPECT_EQ(s.grab_error(10000ms), ErrorCode::kSensorLost);
  EXPECT_LT(Clock::now() - begun, 5s);  // not the caller's deadline
  s.script.silent = false;
  EXPECT_TRUE(s.grab().ok());
  const SessionStatus status = s.session->status();
  EXPECT_EQ(status.losses, 1u);
  EXPECT_EQ(status.opened, 2u);
  EXPECT_EQ(status.camera.frames, 2u);  // of both connections
  EXPECT_EQ(s.script.alive, 1);
}

TEST(SensorSession, NobodyWaitsForAccessesOnADeadLink) {
  Station s;
  s.start();
  ASSERT_TRUE(s.grab().ok());
  s.script.dead_link = true;
  const auto begun = Clock::now();
  EXPECT_EQ(s.grab_error(60s), ErrorCode::kSensorLost);
  EXPECT_LT(Clock::now() - begun, kBlocked);  // the trigger alone takes as long
  EXPECT_EQ(s.session->status().state, SessionState::kLost);
  EXPECT_EQ(s.grab_error(50ms), ErrorCode::kSensorLost);
  s.script.dead_link = false;
  EXPECT_TRUE(s.grab(20s).ok());
  EXPECT_EQ(s.session->status().losses, 1u);
}

// The trigger blocks, and so would tearing down: the last resort ends both.
TEST(SensorSession, ALinkThatStaysDeadIsRecoveredWhileTheWorkerIsStuck) {
  Station s;
  s.params.recovery_after = 100ms;
  s.params.recover = [&s](bool in_use) {
    ++s.script.recovered;
    s.script.recovered_in_use += in_use;
    s.script.dead_link = false;
  };
  s.start();
  ASSERT_TRUE(s.grab().ok());
  s.script.dead_link = true;
  EXPECT_EQ(s.grab_error(60s), ErrorCode::kSensorLost);
  EXPECT_TRUE(s.grab(20s).ok());
  EXPECT_EQ(s.script.recovered, 1);
  EXPECT_EQ(s.script.recovered_in_use, 1);
  const SessionStatus status = s.session->status();
  EXPECT_EQ(status.recoveries, 1u);
  EXPECT_EQ(status.losses, 1u);
  EXPECT_EQ(status.opened, 2u);
  EXPECT_EQ(s.script.alive, 1);
}

TEST(SensorSession, TheLastResortIsTriedOnceForALossAndAgainForTheNext) {
  Station s;
  s.params.recovery_after = 100ms;
  s.start();
  for (int loss = 1; loss <= 2; ++loss) {
    ASSERT_TRUE(s.grab(20s).ok());
    s.script.dead_link = true;
    EXPECT_EQ(s.grab_error(60s), ErrorCode::kSensorLost);
    while (s.script.recovered < loss) std::this_thread::sleep_for(5ms);
    std::this_thread::sleep_for(300ms);  // it helped nothing, and the worker is stuck all the while
    EXPECT_EQ(s.script.recovered, loss);
    s.script.dead_link = false;
  }
  EXPECT_TRUE(s.grab(20s).ok());
}

TEST(SensorSession, AQuickTearDownNeedsNoLastResort) {
  Station s;
  s.params.recovery_after = 10s;
  s.start();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(s.grab(20s).ok());
    s.script.silent = true;
    EXPECT_EQ(s.grab_error(60s), ErrorCode::kSensorLost);
    s.script.silent = false;
  }
  EXPECT_TRUE(s.grab(20s).ok());
  EXPECT_EQ(s.script.recovered, 0);
}

TEST(SensorSession, ALastResortThatFailsIsNoted) {
  Station s;
  s.params.recovery_after = 50ms;
  s.params.recover = [](bool) { throw drivers::SensorError("may not be reset"); };
  s.start();
  ASSERT_TRUE(s.grab().ok());
  s.script.dead_link = true;
  EXPECT_EQ(s.grab_error(60s), ErrorCode::kSensorLost);
  while (s.session->status().last_recovery_error.empty()) std::this_thread::sleep_for(5ms);
  s.script.dead_link = false;
  EXPECT_TRUE(s.grab(20s).ok());
  EXPECT_EQ(s.session->status().last_recovery_error, "may not be reset");
  EXPECT_EQ(s.session->status().recoveries, 0u);
}

TEST(SensorSession, ALostConnectionIsNoticedWhileNobodyGrabs) {
  Station s;
  s.start();
  ASSERT_TRUE(s.session->wait_ready(Clock::now() + 5s));
  s.script.control_lost = true;
  while (s.session->status().losses == 0) std::this_thread::sleep_for(5ms);
  s.script.control_lost = false;
  EXPECT_TRUE(s.grab().ok());
}

TEST(SensorSession, AFreeRunGivesFramesTakenAfterTheRequest) {
  Station s(TriggerSource::kFreeRun);
  s.start();
  ASSERT_TRUE(s.session->wait_ready(Clock::now() + 5s));
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(7ms);
    const std::int64_t now_ns = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
    const Result<FrameRef> frame = s.grab();
    ASSERT_TRUE(frame.ok());
    EXPECT_GE(frame.value().frame().capture_ns, now_ns);
  }
  s.script.silent = true;
  ErrorCode code = ErrorCode::kNone;  // one frame may have been on its way
  for (int i = 0; i < 3 && code == ErrorCode::kNone; ++i) code = s.grab_error(10000ms);
  EXPECT_EQ(code, ErrorCode::kSensorLost);
}

TEST(SensorSession, AQuietLineIsNoLoss) {
  Station s(TriggerSource::kLine);
  s.script.silent = true;
  s.start();
  EXPECT_EQ(s.grab_error(600ms), ErrorCode::kSensorTimeout);
  EXPECT_EQ(s.session->status().losses, 0u);
  s.script.silent = false;
  EXPECT_TRUE(s.grab().ok());
}

TEST(SensorSession, TheEndOfARecordingIsToldAndIsNoLoss) {
  Station s;
  s.script.ended = true;
  s.start();
  EXPECT_EQ(s.grab_error(5000ms), ErrorCode::kSensorEnd);
  EXPECT_EQ(s.session->status().losses, 0u);
}

TEST(SensorSession, EndsWhileTheSensorIsAbsentOrSilent) {
  for (const bool absent : {true, false}) {
    Station s;
    s.script.absent = absent;
    s.script.silent = true;
    s.start();
    std::this_thread::sleep_for(20ms);
    s.session.reset();
    EXPECT_EQ(s.script.alive, 0);
  }
}

}  // namespace
}  // namespace binpick::app
