// A sensor that is kept alive: opened, asked for frames, and where it is lost torn down, opened
// again and set up as before. The policy above all drivers, written once.
//
// One worker thread does everything that touches the sensor, since every access on a dead link
// blocks for seconds; who grabs waits for its own deadline only. A frame that does not come within
// the frame deadline is the first sign of a loss: the library's own is five seconds late. Where
// there is a last resort, it is tried while the worker is still stuck. Thread-safe. Frames are
// given back before the session and the pool are destroyed.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/camera_spec.hpp"
#include "sensor/last_resort.hpp"

namespace binpick::app {

struct SessionParams {
  drivers::TriggerSource trigger = drivers::TriggerSource::kSoftware;
  std::chrono::milliseconds frame_deadline{900};
  // Pauses between attempts to open: the first, doubled up to the longest.
  std::chrono::milliseconds backoff_first{50}, backoff_max{400};
  // The last resort, such as a reset of the USB port. Called on the worker after so many failed
  // attempts in a row, and after as many again; and on a thread of its own when the worker is still
  // busy with a lost sensor after `recovery_after`: the sensor is then in use by this session. What
  // it throws is noted.
  int failures_before_recovery = 5;
  std::chrono::milliseconds recovery_after{1000};
  std::function<void(bool in_use)> recover;
};

enum class SessionState { kConnecting, kReady, kLost };
const char* session_state_name(SessionState state);

struct SessionCounts {
  SessionState state = SessionState::kConnecting;
  std::uint64_t opened = 0;         // connections made
  std::uint64_t losses = 0;         // connections lost
  std::uint64_t open_failures = 0;  // attempts
  std::uint64_t recoveries = 0;     // of those that went well
  std::uint64_t retriggers = 0;     // a frame was dropped and asked for again
  std::uint64_t late_frames = 0;    // came when nobody waited any more
  drivers::CameraCounters camera;   // summed over all connections
};
struct SessionStatus : SessionCounts {
  std::string last_error;  // of opening; empty: none yet
  std::string last_recovery_error;
};

class SensorSession {
 public:
  using TimePoint = drivers::Camera::TimePoint;
  using OpenFn = std::function<std::unique_ptr<drivers::Camera>()>;

  // Starts the worker, which opens the sensor. `open` may throw std::exception: it is tried again.
  SensorSession(OpenFn open, FramePool& pool, SessionParams params);
  // Waits for the worker: on a dead link some seconds.
  ~SensorSession();
  SensorSession(const SensorSession&) = delete;
  SensorSession& operator=(const SensorSession&) = delete;

  // A frame taken after this call (line trigger: or waiting already). Never later than the
  // deadline. kSensorTimeout, kSensorLost, kSensorEnd; kFrameTooLarge: no frame will ever fit.
  Result<FrameRef> grab(TimePoint deadline);
  // False when the sensor is not ready by then.
  bool wait_ready(TimePoint deadline);
  // The sensor is likely to be there again: ends the pause before the next attempt to open it.
  void retry_now();
  SessionStatus status() const;
  // Of status(), without allocation.
  SessionCounts counts() const;
  SessionState state() const;
  // What the sensor lacks, as it was opened last; not for use in a cycle.
  std::vector<std::string> missing_features() const;

 private:
  void work();
  std::unique_ptr<drivers::Camera> connect();
  void disconnect(std::unique_ptr<drivers::Camera> camera);
  void serve(drivers::Camera& camera);
  bool serve_request(drivers::Camera& camera, std::uint64_t request);
  bool serve_stream(drivers::Camera& camera);
  bool fits(const Result<FrameRef>& result);
  void post(std::uint64_t request, Result<FrameRef> result);
  void set_state(SessionState state);
  void note_failure(const std::string& message);
  void recover(bool in_use);
  bool pause(std::chrono::milliseconds time);  // false when the session ends
  bool ending() const;

  const OpenFn open_;
  FramePool& pool_;
  const SessionParams params_;

  mutable std::mutex mutex_;
  std::condition_variable to_worker_, to_callers_;
  bool end_ = false;
  bool retry_ = false;                          // asked for, and not yet done
  std::uint64_t requested_ = 0, answered_ = 0;  // numbers of grabs
  bool request_open_ = false;                   // somebody still waits for `requested_`
  std::optional<Result<FrameRef>> answer_;
  std::optional<Error> never_fits_;       // of the sensor that cannot be opened for that
  std::optional<TimePoint> unfit_since_;  // the worker's own
  std::mutex grab_mutex_;                 // one grab at a time
  drivers::Camera* camera_ = nullptr;     // for its counters
  drivers::CameraCounters closed_;        // of connections that are gone
  SessionStatus status_;
  std::vector<std::string> missing_features_;
  // When the connection was last known to work; a frame that was dropped is a sign too.
  TimePoint heard_{};

  LastResort last_resort_;
  std::thread worker_;  // last: everything it uses is made before it
};

}  // namespace binpick::app
