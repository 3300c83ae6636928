#include "acquisition.hpp"

#include <chrono>

namespace binpick::sim {

Acquisition::Acquisition(Sensor& sensor, const FaultBoard& faults, bool loop, Callbacks callbacks)
    : sensor_(sensor), faults_(faults), loop_(loop), callbacks_(std::move(callbacks)) {
  thread_ = std::thread([this] { run(); });
}

Acquisition::~Acquisition() {
  {
    const std::lock_guard guard(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::uint64_t Acquisition::now_ns() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
          .count());
}

void Acquisition::start() {
  sensor_.set_acquiring(true);
  const std::uint32_t limit = sensor_.frames_limit();
  {
    const std::lock_guard guard(mutex_);
    running_ = true;
    ++generation_;
    triggers_pending_ = 0;
    next_time_ = last_frame_time_ = Clock::now();
    stop_at_ = limit == 0 ? 0 : exposures_ + limit;
  }
  changed_.notify_all();
}

void Acquisition::restart() {
  const std::lock_guard guard(mutex_);
  ++generation_;
  exposures_ = 0;
  next_id_ = 1;
}

void Acquisition::stop() {
  {
    const std::lock_guard guard(mutex_);
    running_ = false;
    triggers_pending_ = 0;
  }
  sensor_.set_acquiring(false);
  changed_.notify_all();
}

void Acquisition::trigger(TriggerSource source) {
  if (!sensor_.triggered_by(source)) return;
  bool missed = false;
  {
    const std::lock_guard guard(mutex_);
    missed = !running_ || triggers_pending_ > 0;
    if (!missed) ++triggers_pending_;
  }
  if (missed) sensor_.count_missed_trigger();
  changed_.notify_all();
}

// True when it is time for a frame.
bool Acquisition::wait_for_frame(std::unique_lock<std::mutex>& lock) {
  while (!quit_) {
    if (!running_) {
      changed_.wait(lock);
    } else if (sensor_.trigger_mode()) {
      if (triggers_pending_ > 0) {
        --triggers_pending_;
        return true;
      }
      changed_.wait(lock);
    } else {
      const Clock::time_point now = Clock::now();
      if (now >= next_time_) {
        const auto period = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(1 / sensor_.frame_rate_hz()));
        // Late by more than a frame: go on from now, without a burst.
        next_time_ = now - next_time_ > period ? now + period : next_time_ + period;
        return true;
      }
      changed_.wait_until(lock, next_time_);
    }
  }
  return false;
}

void Acquisition::make_frame(std::unique_lock<std::mutex>& lock) {
  const std::uint64_t generation = generation_, index = exposures_, id = next_id_;
  const Clock::time_point now = Clock::now();
  const double pause_s = std::chrono::duration<double>(now - last_frame_time_).count();
  last_frame_time_ = now;
  lock.unlock();
  const std::vector<SensorFrame> frames =
      sensor_.expose(index, id, now_ns(), callbacks_.multipart());
  if (faults_.on(kSlow)) {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(faults_.value(kSlow)));
  }
  const bool lost_after_idle = faults_.on(kIdle) && pause_s >= faults_.value(kIdle);
  const bool sends = !lost_after_idle && !faults_.on(kFrozen) && !faults_.on(kStopStream);
  for (const SensorFrame& frame : frames) {
    lock.lock();
    const bool current = running_ && generation == generation_;
    lock.unlock();
    if (!current) break;
    if (sends) callbacks_.deliver(frame);
  }
  ++frames_made_;
  const auto image_count = static_cast<std::uint64_t>(sensor_.image_count());
  lock.lock();
  if (generation != generation_) return;
  ++exposures_;
  next_id_ += frames.size();
  const bool finished =
      (stop_at_ != 0 && exposures_ >= stop_at_) || (!loop_ && exposures_ >= image_count);
  if (finished && running_) {
    running_ = false;
    lock.unlock();
    sensor_.set_acquiring(false);
    lock.lock();
  }
}

void Acquisition::run() {
  std::unique_lock lock(mutex_);
  while (wait_for_frame(lock)) make_frame(lock);
}

}  // namespace binpick::sim
