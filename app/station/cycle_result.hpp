// What the station is told to do, and what it answers: plain values between the cycle and whoever
// drives and watches it (Modbus, the control socket, free running, the recorder).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "binpick/base/result.hpp"
#include "binpick/check/frame_check.hpp"
#include "binpick/geometry/pose.hpp"
#include "binpick/report/detection.hpp"
#include "config/config.hpp"
#include "fixed_text.hpp"
#include "modbus/command.hpp"
#include "station/cause.hpp"

namespace binpick::app {

using OrderCode = modbus::map::CommandCode;
const char* order_name(OrderCode code);

enum class OrderSource : int { kPlc = 0, kControl, kFreeRun };

struct Order {
  OrderCode code = OrderCode::kDetect;
  OrderSource source = OrderSource::kPlc;
  std::uint32_t sequence = 0;    // as its source counts
  int recipe = 0;                // 0: the selected one
  int picks_max = 0;             // 0: the recipe's
  int deadline_ms = 0;           // from received_ns; 0: the configured one
  int page = 0;                  // of kPage
  bool has_flange_pose = false;  // needed where the sensor rides on the robot
  Pose T_base_flange;
  std::int64_t received_ns = 0;        // monotonic
  Cause refusal = Cause::kDone;        // otherwise: its source found that it cannot be carried out
  modbus::CommandRegisters written{};  // of the PLC: the command block as it was
};

struct Pick {
  Pose T_ref_pick;  // mm; the reference is CycleResult::pose_frame
  double score = 0;
  bool symmetric = false;       // Detection::symmetric
  bool pose_ambiguous = false;  // pose_ambiguous(Detection)
  double visible_fraction = 0;
  double depth_residual_mm = 0;
  int model = 0;  // index into the recipe's models
};

struct CycleTimes {
  double wait_ms = 0;  // from the order's arrival to its start
  double grab_ms = 0;
  double detect_ms = 0;
  double rank_ms = 0;
  double total_ms = 0;  // from the order's arrival to the answer
};

struct CycleResult {
  std::uint64_t cycle = 0;  // counts orders that grab or process a frame, from 1
  Order order;
  Cause cause = Cause::kNoResult;
  std::uint16_t no_pick_reasons = 0;  // bits of NoPickReason
  Error error;                        // what core or driver said, behind a fault
  FrameFindings findings;             // of the frame that was searched, or refused
  bool late = false;                  // the answer came after its deadline
  int recipe = 0;
  PoseFrame pose_frame = PoseFrame::kCamera;
  CycleTimes times;
  std::uint64_t frame_sequence = 0;
  std::int64_t capture_ns = 0;       // monotonic; 0: no frame
  std::int64_t capture_unix_ns = 0;  // the same moment on the calendar's clock
  int detections = 0;                // accepted by the detector; picks are the best ranked of them
  std::array<int, kDropReasonCount> dropped{};
  std::array<double, kStageCount> stage_ms{};
  int page = 0;                 // of the picks, from 1; 0: nothing was looked for
  std::span<const Pick> picks;  // best first; borrowed
};

enum class StationState : int {
  kIdle = 0,       // no result yet, or flushed
  kGrabbing = 1,   // waiting for the frame
  kComputing = 2,  // the frame is there, the robot may move
  kDone = 3,       // the answer is there
  kFault = 4,      // the last order failed; the next one is tried, unless faults are latched
};
const char* station_state_name(StationState state);

// What a person reads of CycleResult::error. Allocates nothing.
void write_error(const Error& error, FixedText& text);

}  // namespace binpick::app
