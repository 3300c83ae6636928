#include "binpick/drivers/camera.hpp"

#include <numeric>

namespace binpick::drivers {

const char* drop_reason_name(DropReason reason) {
  switch (reason) {
    case DropReason::kNone:
      return "none";
    case DropReason::kIncomplete:
      return "incomplete";
    case DropReason::kShortPayload:
      return "payload size";
    case DropReason::kPartBounds:
      return "part bounds";
    case DropReason::kSize:
      return "image size";
    case DropReason::kFormat:
      return "format";
    case DropReason::kNoDepth:
      return "no depth";
    case DropReason::kScan3d:
      return "scan3d values";
    case DropReason::kStale:
      return "stale";
    case DropReason::kPoolEmpty:
      return "pool empty";
    case DropReason::kSuperseded:
      return "superseded";
    case DropReason::kCount:
      break;
  }
  return "unknown";
}

FrameTooLargeError::FrameTooLargeError(const std::string& uri, int width_px, int height_px,
                                       const FramePoolParams& planned)
    : SensorError(uri + ": its frames are " + std::to_string(width_px) + "x" +
                  std::to_string(height_px) + " px (Width, Height), planned are " +
                  std::to_string(planned.width_max) + "x" + std::to_string(planned.height_max)),
      width(width_px),
      height(height_px) {}

std::uint64_t CameraCounters::dropped_total() const {
  return std::accumulate(dropped.begin(), dropped.end(), std::uint64_t{0}) -
         dropped_count(DropReason::kSuperseded);
}

}  // namespace binpick::drivers
