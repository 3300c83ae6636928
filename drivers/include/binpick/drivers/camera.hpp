// The one interface of frame sources: live sensors, recordings and doubles look alike from above.
// It starts, waits, triggers and stops; retry, reconnection and recording live above it, once.
// Thread: one at a time, except counters(), which any thread may call.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "binpick/base/result.hpp"
#include "binpick/frame/frame_pool.hpp"

namespace binpick::drivers {

// What keeps a sensor from being opened or started; one sentence that names its URI or feature.
struct SensorError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The sensor's frames are larger than the pool's slots.
struct FrameTooLargeError : SensorError {
  FrameTooLargeError(const std::string& uri, int width, int height, const FramePoolParams& planned);
  int width, height;
};

// The same of one frame; error_text.hpp knows how to read it.
inline Error frame_too_large(int width, int height) {
  return {ErrorCode::kFrameTooLarge, (static_cast<long long>(width) << 16) + height, "frame size"};
}

// Why a frame was not handed on. The numbers are the `detail` of kSensorFrameDropped.
enum class DropReason : int {
  kNone = 0,
  kIncomplete,    // packets or transfers are missing
  kShortPayload,  // fewer bytes arrived than the frame announces, or more
  kPartBounds,    // a part lies outside of what was received
  kSize,          // not the size that the sensor was set up for, or larger than the pool's slots
  kFormat,        // a pixel format or payload that is not understood
  kNoDepth,       // no part carries depth
  kScan3d,        // the frame's own Scan3d values (chunks) cannot be used
  kStale,         // taken before the trigger, or not newer than the frame before it
  kPoolEmpty,     // every slot of the pool is held
  kSuperseded,    // free run: a newer frame was already there
  kCount
};
inline constexpr int kDropReasonCount = static_cast<int>(DropReason::kCount);
const char* drop_reason_name(DropReason reason);

// Since start; a snapshot.
struct CameraCounters {
  std::uint64_t frames = 0;                               // handed on
  std::array<std::uint64_t, kDropReasonCount> dropped{};  // by DropReason
  std::uint64_t frames_missed = 0;                        // by the source's numbering; never came
  std::uint64_t packets_resent = 0, packets_missing = 0;  // GigE Vision
  std::uint64_t underruns = 0;                            // no driver buffer was free

  std::uint64_t dropped_count(DropReason reason) const {
    return dropped[static_cast<std::size_t>(reason)];
  }
  // All of them but those that a free run passes over on purpose.
  std::uint64_t dropped_total() const;
};

class Camera {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  virtual ~Camera() = default;

  // Makes all buffers and lets frames come. The pool outlives the stop. Throws SensorError.
  virtual void start(FramePool& pool) = 0;
  // The next frame (in free run: the newest, unless the spec wants each). Errors: kSensorTimeout;
  // kSensorFrameDropped as soon as a frame had to be dropped, so that the caller may trigger again;
  // kSensorLost; kSensorEnd; kSensorNotStarted; kFrameTooLarge. Allocates nothing.
  virtual Result<FrameRef> wait_frame(TimePoint deadline) = 0;
  // Software trigger: one frame. What came before is stale from here on. kNone, kSensorRefused (the
  // source is not triggered by software), kSensorLost. On a dead link it may take seconds.
  [[nodiscard]] virtual Error trigger() = 0;
  // Frames end; may be started again. On a dead link it may take seconds.
  virtual void stop() = 0;
  virtual CameraCounters counters() const = 0;
  // Features that the sensor lacks, of those that its profile names and the commands use; found by
  // the last start. None of them was needed for it.
  virtual std::vector<std::string> missing_features() const { return {}; }
};

}  // namespace binpick::drivers
