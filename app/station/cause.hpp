// How an order ended, and why there are no more picks. The numbers are those of the register map,
// which is where they are written down for the PLC programmer; they are never reused and never
// change their meaning. modbus_link.cpp checks that both lists agree.
#pragma once

#include <cstdint>

namespace binpick::app {

enum class Cause : std::uint16_t {
  kNoResult = 0,  // nothing was answered since start
  kDone = 1,
  kCutShort = 2,  // done, but the deadline ended the search before everything was looked at
  // Refused: nothing was done
  kCommandUnknown = 100,
  kRecipeUnknown = 101,
  kPicksMaxTooLarge = 102,  // more than station.picks_max
  kDeadlineTooShort = 103,  // less than station.deadline_min_ms
  kPageUnknown = 104,
  kFlangePoseInvalid = 105,  // the sensor rides on the robot, and no pose came
  kBusy = 106,
  kNothingCaptured = 107,  // process without a frame that is kept
  kNothingToPage = 108,
  kInFault = 109,  // station.fault_latched: clear the fault first
  kFreeRunning = 110,
  // Failed: the station is in the fault state
  kSensorTimeout = 200,
  kSensorLost = 201,
  kFrameDamaged = 202,
  kSensorRefused = 203,
  kDeadlineMissed = 204,   // it came before anything was verified
  kDetectionFailed = 205,  // the detector refused the frame; Error says why
  kPlcHeartbeatLost = 206,
  kInternalFault = 207,
};

const char* cause_name(Cause cause);  // snake_case, as in the register map

constexpr bool is_done(Cause cause) {
  return cause == Cause::kDone || cause == Cause::kCutShort;
}
constexpr bool is_refusal(Cause cause) {
  return static_cast<int>(cause) >= 100 && static_cast<int>(cause) < 200;
}
constexpr bool is_fault(Cause cause) {
  return static_cast<int>(cause) >= 200;
}

// Bits of CycleResult::no_pick_reasons.
enum NoPickReason : std::uint16_t {
  kNothingFound = 1 << 0,   // nothing in the frame resembles the part
  kBelowScore = 1 << 1,     // some or all that was found scores less than the recipe's min_score
  kTooHidden = 1 << 2,      // of some or all too little can be seen
  kContradicted = 1 << 3,   // measured surface lies behind some or all
  kPoseUncertain = 1 << 4,  // refinement did not settle
  kDeadline = 1 << 7,
  kNoMeasurement = 1 << 8,  // no valid depth in the region
  kNoFrame = 1 << 9,
  kLimit = 1 << 10,  // more picks than wanted or kept
};

}  // namespace binpick::app
