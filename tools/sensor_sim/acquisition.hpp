// When a simulated sensor makes frames: free run at its frame rate, or on triggers. It has a thread
// of its own, so that a trigger starts its frame at once whatever the control channel does.
// Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "fault_board.hpp"
#include "sensor.hpp"

namespace binpick::sim {

class Acquisition {
 public:
  struct Callbacks {
    std::function<bool()> multipart;                  // may all components go in one frame?
    std::function<void(const SensorFrame&)> deliver;  // sends it; on the acquisition's thread
  };

  // `loop`: after the last image comes the first; else no frame does.
  Acquisition(Sensor& sensor, const FaultBoard& faults, bool loop, Callbacks callbacks);
  ~Acquisition();  // stops and joins

  void start();
  void stop();     // without waiting for a frame that is on its way
  void restart();  // the next frame is of the first image and has id 1: a stream was opened
  // A software trigger or an edge on a line. One may wait while a frame is on its way; more are
  // counted as missed.
  void trigger(TriggerSource source);

  std::uint64_t frames_made() const { return frames_made_; }

  // Nanoseconds since this machine's start, which is the sensor's clock.
  static std::uint64_t now_ns();

 private:
  using Clock = std::chrono::steady_clock;
  void run();
  bool wait_for_frame(std::unique_lock<std::mutex>& lock);
  void make_frame(std::unique_lock<std::mutex>& lock);

  Sensor& sensor_;
  const FaultBoard& faults_;
  const bool loop_;
  const Callbacks callbacks_;
  std::atomic<std::uint64_t> frames_made_{0};

  std::mutex mutex_;
  std::condition_variable changed_;
  bool quit_ = false;
  bool running_ = false;
  int triggers_pending_ = 0;
  std::uint64_t generation_ = 0;  // of starts: a frame of an earlier one is not sent
  std::uint64_t exposures_ = 0, next_id_ = 1;
  std::uint64_t stop_at_ = 0;  // exposures; 0: no limit
  Clock::time_point next_time_, last_frame_time_;
  Dice dice_{1};
  std::thread thread_;
};

}  // namespace binpick::sim
