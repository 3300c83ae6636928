#include "replay/replay_camera.hpp"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"

namespace binpick::drivers {
namespace {

using Clock = std::chrono::steady_clock;

// Decoded frames that wait: enough for a decoder that is interrupted now and then.
constexpr std::size_t kAheadMax = 3;
// The reader looks so often whether a frame was taken. It is not woken for that: who took the frame
// is about to compute, and would wait for its processor until the reader's work is done.
constexpr std::chrono::milliseconds kReaderPeriod{10};
// Where the recording has no times.
constexpr double kFrameRate_hz = 10;

struct DecodedFrame {
  std::optional<LoadedFrame> loaded;  // nothing: the file cannot be read, or it was filled
  std::int64_t device_ns = 0;
  std::uint64_t sequence = 0;  // from 1, over all rounds
  FrameRef filled;             // the same, in the pool; empty: it had no room yet
};

std::int64_t steady_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

class ReplayCamera final : public Camera {
 public:
  explicit ReplayCamera(const CameraSpec& spec)
      : spec_(spec), data_(spec.uri.substr(spec.uri.find(':') + 1), spec.split) {
    for (const int scene_id : data_.scene_ids()) {
      scenes_.push_back(data_.scene(scene_id));
      for (const auto& [im_id, camera] : scenes_.back().frames)
        frames_.push_back({scenes_.size() - 1, im_id});
    }
    if (frames_.empty()) throw SensorError(spec.uri + ": holds no frame");
  }
  ~ReplayCamera() override { ReplayCamera::stop(); }

  void start(FramePool& pool) override;
  Result<FrameRef> wait_frame(TimePoint deadline) override;
  Error trigger() override;
  void stop() override;
  CameraCounters counters() const override;

 private:
  struct Place {
    std::size_t scene;
    int im_id;
  };
  void read_ahead();
  bool wants_filling() const;  // mutex_ is held
  DecodedFrame decode(std::uint64_t index) const;
  std::int64_t due_after_ns(std::uint64_t index) const;
  void fill(DecodedFrame& decoded);
  Result<FrameRef> hand_on(DecodedFrame decoded);
  Error drop(DropReason reason);

  CameraSpec spec_;
  BopDataset data_;
  std::vector<BopScene> scenes_;
  std::vector<Place> frames_;

  FramePool* pool_ = nullptr;
  TimePoint begun_;
  int triggers_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<DecodedFrame> ahead_;
  bool end_ = false, read_all_ = false;
  std::uint64_t fill_tried_ = 0;  // sequence of the last frame that was to be filled ahead
  bool filling_ = false;          // the first in the queue; it stays there meanwhile
  CameraCounters counters_;
  std::thread reader_;
};

void ReplayCamera::start(FramePool& pool) {
  stop();
  pool_ = &pool;
  end_ = read_all_ = false;
  fill_tried_ = 0;
  triggers_ = 0;
  counters_ = {};
  begun_ = Clock::now();
  reader_ = std::thread([this] { read_ahead(); });
}

void ReplayCamera::stop() {
  if (!reader_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  reader_.join();
  ahead_.clear();
  pool_ = nullptr;
}

DecodedFrame ReplayCamera::decode(std::uint64_t index) const {
  const Place place = frames_[index % frames_.size()];
  const BopScene& scene = scenes_[place.scene];
  DecodedFrame decoded;
  decoded.sequence = index + 1;
  decoded.device_ns = scene.frames.at(place.im_id).device_ns;
  try {
    decoded.loaded = data_.load_frame(scene, place.im_id);
  } catch (const DatasetError&) {
    // Counted when its turn comes: one damaged file is no reason to end a replay.
  }
  return decoded;
}

bool ReplayCamera::wants_filling() const {
  return !ahead_.empty() && ahead_.front().loaded && ahead_.front().sequence > fill_tried_;
}

// The reader's thread: copies the frame that comes next into the pool, so that nobody waits for
// that, and decodes those after it.
void ReplayCamera::read_ahead() {
  pthread_setname_np(pthread_self(), "replay-reader");
  std::uint64_t index = 0;
  const auto more = [&] { return spec_.loop || index < frames_.size(); };
  std::unique_lock lock(mutex_);
  for (;;) {
    const auto has_work = [&] {
      return end_ || wants_filling() || (more() && ahead_.size() < kAheadMax);
    };
    while (!changed_.wait_for(lock, kReaderPeriod, has_work)) {
    }
    if (end_) return;
    if (wants_filling()) {
      DecodedFrame& first = ahead_.front();  // nobody takes it meanwhile
      fill_tried_ = first.sequence;
      filling_ = true;
      lock.unlock();
      if (pool_->free_count() > 0) fill(first);
      lock.lock();
      filling_ = false;
    } else {
      lock.unlock();
      DecodedFrame decoded = decode(index++);
      lock.lock();
      ahead_.push_back(std::move(decoded));
      read_all_ = !more();
    }
    changed_.notify_all();
  }
}

// From the start of the replay; the recording's own times where each frame has one.
std::int64_t ReplayCamera::due_after_ns(std::uint64_t index) const {
  const auto time_of = [&](std::size_t i) {
    return scenes_[frames_[i].scene].frames.at(frames_[i].im_id).capture_ns;
  };
  const double rate_hz = spec_.frame_rate_hz.value_or(kFrameRate_hz);
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
  const std::int64_t first = time_of(0), last = time_of(frames_.size() - 1);
  const std::size_t at = index % frames_.size();
  if (spec_.frame_rate_hz || first == 0 || last < first || time_of(at) < first)
    return static_cast<std::int64_t>(index) * period_ns;
  const auto round = static_cast<std::int64_t>(index / frames_.size());
  return round * (last - first + period_ns) + time_of(at) - first;
}

Error ReplayCamera::drop(DropReason reason) {
  const std::lock_guard lock(mutex_);
  ++counters_.dropped[static_cast<std::size_t>(reason)];
  return {ErrorCode::kSensorFrameDropped, static_cast<long long>(reason), drop_reason_name(reason)};
}

Result<FrameRef> ReplayCamera::wait_frame(TimePoint deadline) {
  if (pool_ == nullptr) return Error{ErrorCode::kSensorNotStarted, 0, "recording"};
  if (spec_.trigger == TriggerSource::kSoftware && triggers_ == 0) {
    std::this_thread::sleep_until(deadline);
    return Error{ErrorCode::kSensorTimeout, 0, "recording"};
  }
  DecodedFrame decoded;
  {
    std::unique_lock lock(mutex_);
    if (ahead_.empty()) changed_.notify_all();
    if (!changed_.wait_until(lock, deadline,
                             [&] { return !filling_ && (!ahead_.empty() || read_all_); }))
      return Error{ErrorCode::kSensorTimeout, 0, "recording"};
    if (ahead_.empty()) return Error{ErrorCode::kSensorEnd, 0, "recording"};
    if (spec_.trigger != TriggerSource::kSoftware && spec_.paced) {
      const TimePoint due =
          begun_ + std::chrono::nanoseconds(due_after_ns(ahead_.front().sequence - 1));
      const bool in_time = due <= deadline;
      lock.unlock();
      std::this_thread::sleep_until(in_time ? due : deadline);
      if (!in_time) return Error{ErrorCode::kSensorTimeout, 0, "recording"};
      lock.lock();
      changed_.wait(lock, [&] { return !filling_; });
    }
    decoded = std::move(ahead_.front());
    ahead_.pop_front();
  }
  triggers_ = 0;
  return hand_on(std::move(decoded));
}

// Leaves it empty where the pool has no room.
void ReplayCamera::fill(DecodedFrame& decoded) {
  const Frame view = decoded.loaded->view();
  if (!pool_->fits(view.camera.width, view.camera.height)) return;
  FrameRef ref = pool_->try_take();
  if (!ref) return;
  FrameSlot& slot = ref.slot();
  std::copy(decoded.loaded->depth_mm.begin(), decoded.loaded->depth_mm.end(),
            slot.depth_mm.begin());
  std::copy(decoded.loaded->intensity.begin(), decoded.loaded->intensity.end(),
            slot.intensity.begin());
  slot.frame = view;
  if (!view.depth_mm.empty()) slot.frame.depth_mm.data = slot.depth_mm.data();
  if (!view.intensity.empty()) slot.frame.intensity.data = slot.intensity.data();
  slot.frame.device_ns = decoded.device_ns;
  slot.frame.sequence = decoded.sequence;
  decoded.filled = std::move(ref);
  decoded.loaded.reset();  // so that what is held does not depend on who is how fast
}

Result<FrameRef> ReplayCamera::hand_on(DecodedFrame decoded) {
  if (!decoded.filled) {
    if (!decoded.loaded) return drop(DropReason::kIncomplete);
    const Frame view = decoded.loaded->view();
    if (!pool_->fits(view.camera.width, view.camera.height)) {
      static_cast<void>(drop(DropReason::kSize));
      return frame_too_large(view.camera.width, view.camera.height);
    }
    fill(decoded);
  }
  if (!decoded.filled) return drop(DropReason::kPoolEmpty);
  decoded.filled.slot().frame.capture_ns = steady_ns();
  const std::lock_guard lock(mutex_);
  ++counters_.frames;
  return std::move(decoded.filled);
}

Error ReplayCamera::trigger() {
  if (pool_ == nullptr) return {ErrorCode::kSensorNotStarted, 0, "recording"};
  if (spec_.trigger != TriggerSource::kSoftware) return {ErrorCode::kSensorRefused, 0, "trigger"};
  triggers_ = 1;
  return {};
}

CameraCounters ReplayCamera::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace

std::unique_ptr<Camera> open_replay_camera(const CameraSpec& spec) {
  return std::make_unique<ReplayCamera>(spec);
}

}  // namespace binpick::drivers
