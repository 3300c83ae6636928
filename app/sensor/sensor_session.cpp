#include "sensor/sensor_session.hpp"

#include <pthread.h>

#include <algorithm>

namespace binpick::app {
namespace {

using drivers::CameraCounters;
using drivers::TriggerSource;
using Clock = std::chrono::steady_clock;

// Between two looks at an idle sensor's connection.
constexpr std::chrono::milliseconds kIdlePeriod{200};
// How much later than the worker a caller notices that no frame came.
constexpr std::chrono::milliseconds kWorkerMargin{50};
// Before a sensor that was busy is triggered again.
constexpr std::chrono::milliseconds kBusyPause{5};

CameraCounters sum(CameraCounters a, const CameraCounters& b) {
  a.frames += b.frames;
  for (std::size_t i = 0; i < a.dropped.size(); ++i) a.dropped[i] += b.dropped[i];
  a.frames_missed += b.frames_missed;
  a.packets_resent += b.packets_resent;
  a.packets_missing += b.packets_missing;
  a.underruns += b.underruns;
  return a;
}

// The frame is whole, but not what the sensor was set to when it was opened: somebody changed it
// since, or its features told something false. Opening it again reads them anew.
bool unfit(const Error& error) {
  using drivers::DropReason;
  if (error.code != ErrorCode::kSensorFrameDropped) return false;
  switch (static_cast<DropReason>(error.detail)) {
    case DropReason::kShortPayload:
    case DropReason::kPartBounds:
    case DropReason::kSize:
    case DropReason::kFormat:
    case DropReason::kNoDepth:
    case DropReason::kScan3d:
      return true;
    default:
      return false;
  }
}

std::int64_t ns_of(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

}  // namespace

const char* session_state_name(SessionState state) {
  switch (state) {
    case SessionState::kConnecting:
      return "connecting";
    case SessionState::kReady:
      return "ready";
    case SessionState::kLost:
      return "lost";
  }
  return "unknown";
}

SensorSession::SensorSession(OpenFn open, FramePool& pool, SessionParams params)
    : open_(std::move(open)),
      pool_(pool),
      params_(std::move(params)),
      last_resort_(params_.recover ? std::function<void()>([this] { recover(true); }) : nullptr,
                   params_.recovery_after),
      worker_([this] { work(); }) {}

SensorSession::~SensorSession() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  to_worker_.notify_all();
  to_callers_.notify_all();
  worker_.join();
}

bool SensorSession::ending() const {
  const std::lock_guard lock(mutex_);
  return end_;
}

bool SensorSession::pause(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !to_worker_.wait_for(lock, time, [&] { return end_; });
}

void SensorSession::retry_now() {
  {
    const std::lock_guard lock(mutex_);
    retry_ = true;
  }
  to_worker_.notify_all();
}

void SensorSession::recover(bool in_use) {
  std::string error;
  try {
    params_.recover(in_use);
  } catch (const std::exception& e) {
    error = e.what();
  }
  const std::lock_guard lock(mutex_);
  if (error.empty()) ++status_.recoveries;
  status_.last_recovery_error = std::move(error);
}

void SensorSession::set_state(SessionState state) {
  if (state == SessionState::kLost) last_resort_.begin();
  {
    const std::lock_guard lock(mutex_);
    if (state == SessionState::kReady) ++status_.opened;
    if (state == SessionState::kLost && status_.state != SessionState::kLost) {
      ++status_.losses;
      // Who waits learns it now, before seconds of tearing down. Who began to wait after the loss
      // was noticed waits for the sensor's return.
      if (request_open_ && answered_ < requested_) {
        answer_.emplace(Error{ErrorCode::kSensorLost, 0, "sensor"});
        answered_ = requested_;
      }
    }
    status_.state = state;
  }
  to_callers_.notify_all();
}

void SensorSession::note_failure(const std::string& message) {
  const std::lock_guard lock(mutex_);
  ++status_.open_failures;
  status_.last_error = message;
}

void SensorSession::work() {
  pthread_setname_np(pthread_self(), "sensor");
  while (!ending()) {
    std::unique_ptr<drivers::Camera> camera = connect();
    if (!camera) return;
    set_state(SessionState::kReady);
    serve(*camera);
    if (!ending()) set_state(SessionState::kLost);
    disconnect(std::move(camera));
  }
}

std::unique_ptr<drivers::Camera> SensorSession::connect() {
  std::chrono::milliseconds backoff = params_.backoff_first;
  for (int failures = 0; !ending();) {
    try {
      std::unique_ptr<drivers::Camera> camera = open_();
      camera->start(pool_);
      unfit_since_.reset();
      std::vector<std::string> missing = camera->missing_features();
      const std::lock_guard lock(mutex_);
      camera_ = camera.get();
      never_fits_.reset();
      missing_features_ = std::move(missing);
      return camera;
    } catch (const drivers::FrameTooLargeError& e) {
      note_failure(std::string(e.what()) + ": raise sensor.width_max and sensor.height_max");
      const std::lock_guard lock(mutex_);
      never_fits_ = drivers::frame_too_large(e.width, e.height);
    } catch (const std::exception& e) {
      note_failure(e.what());
    }
    ++failures;
    if (params_.recover && failures % params_.failures_before_recovery == 0) recover(false);
    std::unique_lock lock(mutex_);
    // An arrival while the attempt before it was failing counts too.
    const bool called =
        to_worker_.wait_for(lock, backoff, [&] { return end_ || retry_; }) && retry_;
    retry_ = false;
    backoff = called ? params_.backoff_first : std::min(2 * backoff, params_.backoff_max);
  }
  return nullptr;
}

void SensorSession::disconnect(std::unique_ptr<drivers::Camera> camera) {
  camera->stop();
  {
    const std::lock_guard lock(mutex_);
    closed_ = sum(closed_, camera->counters());
    camera_ = nullptr;
  }
  camera.reset();
  last_resort_.end();
}

// False when nothing but unfit frames came for two frame deadlines.
bool SensorSession::fits(const Result<FrameRef>& result) {
  if (result.ok() || !unfit(result.error())) {
    if (result.ok()) unfit_since_.reset();
    return true;
  }
  if (!unfit_since_) unfit_since_ = Clock::now();
  return Clock::now() - *unfit_since_ < 2 * params_.frame_deadline;
}

// Until the sensor is lost or the session ends.
void SensorSession::serve(drivers::Camera& camera) {
  for (;;) {
    std::uint64_t request = 0;
    {
      std::unique_lock lock(mutex_);
      const auto wanted = [&] { return end_ || (request_open_ && answered_ < requested_); };
      if (params_.trigger == TriggerSource::kSoftware)
        to_worker_.wait_for(lock, kIdlePeriod, wanted);
      if (end_) return;
      if (wanted()) request = requested_;
    }
    bool alive = true;
    if (params_.trigger != TriggerSource::kSoftware) {
      alive = serve_stream(camera);
    } else if (request != 0) {
      alive = serve_request(camera, request);
    } else {
      const Result<FrameRef> idle = camera.wait_frame(Clock::now());
      alive = idle.ok() || idle.error().code != ErrorCode::kSensorLost;
    }
    if (!alive) return;
  }
}

// Triggers until a frame is good or the frame deadline is over; false: the sensor is lost.
bool SensorSession::serve_request(drivers::Camera& camera, std::uint64_t request) {
  const Clock::time_point deadline = Clock::now() + params_.frame_deadline;
  for (;;) {
    const Error refused = camera.trigger();
    if (refused.code == ErrorCode::kSensorLost) return false;
    if (refused.code != ErrorCode::kNone) {
      if (Clock::now() + kBusyPause >= deadline || !pause(kBusyPause)) return false;
      continue;
    }
    Result<FrameRef> result = camera.wait_frame(deadline);
    const bool over = Clock::now() >= deadline;
    if (!fits(result)) return false;
    if (result.ok() || result.error().code == ErrorCode::kSensorEnd ||
        result.error().code == ErrorCode::kFrameTooLarge) {
      post(request, std::move(result));
      return true;
    }
    const ErrorCode code = result.error().code;
    if (code != ErrorCode::kSensorFrameDropped) return false;
    if (over) {
      // Frames come, but none is good: the sensor is there, opening it again would not help.
      post(request, std::move(result));
      return true;
    }
    if (result.error().detail == static_cast<long long>(drivers::DropReason::kPoolEmpty) &&
        !pause(kBusyPause))
      return true;
    const std::lock_guard lock(mutex_);
    ++status_.retriggers;
    heard_ = Clock::now();
  }
}

// One frame of a sensor that runs by itself or by a line.
bool SensorSession::serve_stream(drivers::Camera& camera) {
  // Short, so that the end of the session is seen; silence is added up over the calls.
  const Clock::time_point deadline = Clock::now() + params_.frame_deadline;
  for (;;) {
    Result<FrameRef> result = camera.wait_frame(std::min(deadline, Clock::now() + kIdlePeriod));
    if (ending()) return true;
    if (!fits(result)) return false;
    if (result.ok() || result.error().code == ErrorCode::kFrameTooLarge) {
      std::uint64_t request = 0;
      {
        const std::lock_guard lock(mutex_);
        request = requested_;
      }
      post(request, std::move(result));
      return true;
    }
    const ErrorCode code = result.error().code;
    if (code == ErrorCode::kSensorFrameDropped) return true;  // it lives
    if (code == ErrorCode::kSensorEnd) {
      post(0, std::move(result));
      return pause(kIdlePeriod);
    }
    if (code != ErrorCode::kSensorTimeout) return false;
    // A line that stays quiet is no loss.
    if (Clock::now() >= deadline) return params_.trigger == TriggerSource::kLine;
  }
}

// Hands the result to who waits. A stream's frame stays until a newer one takes its place.
void SensorSession::post(std::uint64_t request, Result<FrameRef> result) {
  {
    const std::lock_guard lock(mutex_);
    const bool stream = params_.trigger != TriggerSource::kSoftware;
    status_.state = SessionState::kReady;  // should a caller have given it up
    if (!stream && (!request_open_ || request != requested_)) {
      ++status_.late_frames;
    } else {
      answer_.emplace(std::move(result));
      answered_ = requested_;
    }
  }
  last_resort_.end();
  to_callers_.notify_all();
}

Result<FrameRef> SensorSession::grab(TimePoint deadline) {
  const std::lock_guard one_at_a_time(grab_mutex_);
  const TimePoint begun = Clock::now();
  const std::int64_t begun_ns = ns_of(begun);
  std::unique_lock lock(mutex_);
  const bool keeps_waiting_frame = params_.trigger == TriggerSource::kLine;
  if (!keeps_waiting_frame) answer_.reset();
  ++requested_;
  request_open_ = true;
  to_worker_.notify_all();
  const auto too_old = [&] {
    return params_.trigger == TriggerSource::kFreeRun && answer_->ok() &&
           answer_->value().frame().capture_ns != 0 &&
           answer_->value().frame().capture_ns < begun_ns;
  };
  // The worker may be inside an access that takes seconds to fail.
  const bool ready_before = status_.state == SessionState::kReady;
  const bool notices_silence = ready_before && params_.trigger != TriggerSource::kLine;
  const auto silence = [&] {
    return std::max(begun, heard_) + params_.frame_deadline + kWorkerMargin;
  };
  TimePoint until = deadline;
  for (;;) {
    until = notices_silence ? std::min(deadline, silence()) : deadline;
    if (!to_callers_.wait_until(lock, until, [&] { return end_ || answer_.has_value(); })) {
      if (until < deadline && until < silence()) continue;  // it was heard of meanwhile
      break;
    }
    if (end_) break;
    if (!too_old()) {
      Result<FrameRef> result = std::move(*answer_);
      answer_.reset();
      request_open_ = false;
      return result;
    }
    answer_.reset();
    answered_ = requested_ - 1;
  }
  request_open_ = false;
  if (notices_silence && !end_ && until < deadline && status_.state == SessionState::kReady) {
    status_.state = SessionState::kLost;
    ++status_.losses;
    last_resort_.begin();
  }
  const bool ready = status_.state == SessionState::kReady;
  if (!ready && never_fits_) return *never_fits_;
  return Error{ready ? ErrorCode::kSensorTimeout : ErrorCode::kSensorLost, 0, "sensor"};
}

bool SensorSession::wait_ready(TimePoint deadline) {
  std::unique_lock lock(mutex_);
  to_callers_.wait_until(lock, deadline,
                         [&] { return end_ || status_.state == SessionState::kReady; });
  return status_.state == SessionState::kReady;
}

SessionState SensorSession::state() const {
  const std::lock_guard lock(mutex_);
  return status_.state;
}

std::vector<std::string> SensorSession::missing_features() const {
  const std::lock_guard lock(mutex_);
  return missing_features_;
}

SessionStatus SensorSession::status() const {
  const std::lock_guard lock(mutex_);
  SessionStatus status = status_;
  status.camera = camera_ != nullptr ? sum(closed_, camera_->counters()) : closed_;
  return status;
}

SessionCounts SensorSession::counts() const {
  const std::lock_guard lock(mutex_);
  SessionCounts counts = status_;
  counts.camera = camera_ != nullptr ? sum(closed_, camera_->counters()) : closed_;
  return counts;
}

}  // namespace binpick::app
