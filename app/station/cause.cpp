#include "station/cause.hpp"

namespace binpick::app {

const char* cause_name(Cause cause) {
  switch (cause) {
    case Cause::kNoResult:
      return "no_result";
    case Cause::kDone:
      return "done";
    case Cause::kCutShort:
      return "cut_short";
    case Cause::kCommandUnknown:
      return "command_unknown";
    case Cause::kRecipeUnknown:
      return "recipe_unknown";
    case Cause::kPicksMaxTooLarge:
      return "picks_max_too_large";
    case Cause::kDeadlineTooShort:
      return "deadline_too_short";
    case Cause::kPageUnknown:
      return "page_unknown";
    case Cause::kFlangePoseInvalid:
      return "flange_pose_invalid";
    case Cause::kBusy:
      return "busy";
    case Cause::kNothingCaptured:
      return "nothing_captured";
    case Cause::kNothingToPage:
      return "nothing_to_page";
    case Cause::kInFault:
      return "in_fault";
    case Cause::kFreeRunning:
      return "free_running";
    case Cause::kSensorTimeout:
      return "sensor_timeout";
    case Cause::kSensorLost:
      return "sensor_lost";
    case Cause::kFrameDamaged:
      return "frame_damaged";
    case Cause::kSensorRefused:
      return "sensor_refused";
    case Cause::kDeadlineMissed:
      return "deadline_missed";
    case Cause::kDetectionFailed:
      return "detection_failed";
    case Cause::kPlcHeartbeatLost:
      return "plc_heartbeat_lost";
    case Cause::kInternalFault:
      return "internal_fault";
  }
  return "unknown";
}

}  // namespace binpick::app
