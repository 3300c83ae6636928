#include "station/cycle.hpp"

#include <algorithm>

#include "frame_findings.hpp"
#include "modbus/answer.hpp"
#include "recorder/depth_codes.hpp"

namespace binpick::app {
namespace {

using Clock = std::chrono::steady_clock;

bool grabs(OrderCode code) {
  return code == OrderCode::kDetect || code == OrderCode::kCapture;
}
bool cycles(OrderCode code) {
  return grabs(code) || code == OrderCode::kProcess;
}

double ms_between(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-6;
}

Cause cause_of(ErrorCode code, bool deadline_came) {
  switch (code) {
    case ErrorCode::kSensorTimeout:
      return deadline_came ? Cause::kDeadlineMissed : Cause::kSensorTimeout;
    case ErrorCode::kSensorLost:
    case ErrorCode::kSensorNotStarted:
    case ErrorCode::kSensorEnd:  // a recording that is over does not come back
      return Cause::kSensorLost;
    case ErrorCode::kSensorFrameDropped:
      return Cause::kFrameDamaged;
    case ErrorCode::kSensorRefused:
      return Cause::kSensorRefused;
    case ErrorCode::kFrameEmpty:
    case ErrorCode::kFrameSizeMismatch:
    case ErrorCode::kFrameTooLarge:
    case ErrorCode::kIntrinsicsInvalid:
    case ErrorCode::kRoiOutsideImage:
    case ErrorCode::kRoiTooLarge:
    case ErrorCode::kFrameWithoutDepth:
    case ErrorCode::kFrameWithoutIntensity:
    case ErrorCode::kFrameRefused:
    case ErrorCode::kModelCameraMismatch:
      return Cause::kDetectionFailed;
    default:
      return Cause::kInternalFault;
  }
}

constexpr std::uint16_t bit(NoPickReason reason) {
  return static_cast<std::uint16_t>(reason);
}

}  // namespace

std::size_t Cycle::footprint(int picks_max) {
  const auto count = static_cast<std::size_t>(picks_max);
  return Arena::padded(count * sizeof(Pick)) + Arena::padded(count * sizeof(int));
}

Cycle::Cycle(const CycleParts& parts, const StationSettings& settings, int picks_max,
             int first_recipe, Arena& arena)
    : parts_(parts),
      settings_(settings),
      picks_(arena.take<Pick>(static_cast<std::size_t>(picks_max))),
      ranking_(arena.take<int>(static_cast<std::size_t>(picks_max))),
      selected_(first_recipe) {
  BINPICK_ASSERT(parts_.recipes.find(first_recipe) != nullptr);
}

const CycleResult& Cycle::run(const Order& order) {
  StationState next = begin(order);
  while (next == StationState::kGrabbing || next == StationState::kComputing) {
    enter(next);
    next = next == StationState::kGrabbing ? grab() : compute();
  }
  finish(next);
  return result_;
}

void Cycle::enter(StationState state) {
  state_.store(state, std::memory_order_release);
  if (parts_.progress != nullptr) parts_.progress(parts_.progress_context);
}

void Cycle::set_plc_lost(bool lost) {
  if (plc_lost_ == lost) return;
  plc_lost_ = lost;
  if (lost) {
    set_free_running(false);
    enter(StationState::kFault);
  } else if (!settings_.fault_latched) {
    leave_fault();
  }
}

void Cycle::leave_fault() {
  if (state() == StationState::kFault)
    enter(result_.cause == Cause::kNoResult ? StationState::kIdle : StationState::kDone);
}

// What the order leads to: grabbing, computing, or at once its end.
StationState Cycle::begin(const Order& order) {
  begun_ns_ = parts_.clock();
  result_.order = order;
  result_.error = {};
  result_.findings = {};
  result_.late = false;
  result_.no_pick_reasons = 0;
  result_.times = {};
  result_.times.wait_ms = ms_between(order.received_ns, begun_ns_);
  // What cannot be understood might have been a cycle: no picks that look like its answer.
  if (cycles(order.code) || order.refusal == Cause::kCommandUnknown) {
    result_.picks = {};
    result_.page = 0;
    result_.detections = 0;
    result_.dropped = {};
    result_.stage_ms = {};
    result_.capture_ns = result_.capture_unix_ns = 0;
    result_.frame_sequence = 0;
  }
  const int deadline_ms = order.deadline_ms > 0 ? order.deadline_ms : settings_.deadline_ms;
  deadline_ns_ = deadline_ms > 0 ? order.received_ns + std::int64_t{1000000} * deadline_ms : 0;
  const Cause refused = refusal(order);
  if (refused != Cause::kDone) return end(refused);
  if (!cycles(order.code)) return end(cause_without_cycle(order));
  recipe_ = parts_.recipes.find(order.recipe != 0 ? order.recipe : selected_recipe());
  result_.recipe = recipe_->number;
  ++result_.cycle;
  return grabs(order.code) ? StationState::kGrabbing : StationState::kComputing;
}

// kDone: it may be carried out.
Cause Cycle::refusal(const Order& order) const {
  if (order.refusal != Cause::kDone) return order.refusal;
  if (order.code == OrderCode::kSelectRecipe || (cycles(order.code) && order.recipe != 0)) {
    if (parts_.recipes.find(order.recipe) == nullptr) return Cause::kRecipeUnknown;
  }
  if (!cycles(order.code)) return Cause::kDone;
  if (plc_lost_ && order.source == OrderSource::kPlc) return Cause::kPlcHeartbeatLost;
  if (state() == StationState::kFault && settings_.fault_latched) return Cause::kInFault;
  if (free_running() && order.source != OrderSource::kFreeRun) return Cause::kFreeRunning;
  if (order.picks_max < 0 || order.picks_max > static_cast<int>(picks_.size()))
    return Cause::kPicksMaxTooLarge;
  if (order.deadline_ms != 0 && order.deadline_ms < settings_.deadline_min_ms)
    return Cause::kDeadlineTooShort;
  if (order.code == OrderCode::kProcess && !frame_) return Cause::kNothingCaptured;
  const bool needs_flange =
      settings_.pose_frame == PoseFrame::kBase && settings_.mounting == Mounting::kFlange;
  const bool has_flange =
      order.code == OrderCode::kProcess ? captured_with_flange_ : order.has_flange_pose;
  return needs_flange && !has_flange ? Cause::kFlangePoseInvalid : Cause::kDone;
}

Cause Cycle::cause_without_cycle(const Order& order) {
  switch (order.code) {
    case OrderCode::kSelectRecipe:
      selected_.store(order.recipe, std::memory_order_relaxed);
      return Cause::kDone;
    case OrderCode::kNextPage:
      return turn_page(result_.page + 1);
    case OrderCode::kPage:
      return turn_page(order.page);
    case OrderCode::kClearFault:
      leave_fault();
      return Cause::kDone;
    case OrderCode::kFlush:
      frame_.reset();
      result_.picks = {};
      result_.page = result_.detections = 0;
      return Cause::kDone;
    case OrderCode::kFreeRunStart:
    case OrderCode::kFreeRunStop:
      set_free_running(order.code == OrderCode::kFreeRunStart);
      return Cause::kDone;
    default:
      return Cause::kDone;
  }
}

Cause Cycle::turn_page(int page) {
  if (result_.page == 0) return Cause::kNothingToPage;
  const int pages = modbus::page_count(static_cast<int>(result_.picks.size()));
  if (page < 1 || page > pages) return Cause::kPageUnknown;
  result_.page = page;
  return Cause::kDone;
}

StationState Cycle::grab() {
  frame_.reset();  // whatever comes of this, the frame before is no longer the one to process
  const Clock::time_point now = Clock::now();
  Clock::time_point until = now + std::chrono::milliseconds(settings_.frame_deadline_ms + 100);
  bool deadline_first = false;
  if (deadline_ns_ != 0) {
    const auto left = std::chrono::nanoseconds(deadline_ns_ - parts_.clock());
    deadline_first = now + left < until;
    if (deadline_first) until = now + left;
  }
  const std::int64_t before_ns = parts_.clock();
  Result<FrameRef> grabbed = parts_.source.grab(until);
  const std::int64_t after_ns = parts_.clock();
  result_.times.grab_ms = ms_between(before_ns, after_ns);
  if (!grabbed.ok()) {
    result_.no_pick_reasons |= bit(NoPickReason::kNoFrame);
    const bool deadline_came = deadline_first && Clock::now() >= until;
    const Cause cause = cause_of(grabbed.error().code, deadline_came);
    result_.error = grabbed.error();
    return end(cause);
  }
  frame_ = std::move(grabbed).value();
  quantize_depth(frame_.slot());
  const Frame& frame = frame_.frame();
  result_.capture_ns = frame.capture_ns != 0 ? frame.capture_ns : after_ns;
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  capture_unix_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count() -
                     (after_ns - result_.capture_ns);
  captured_with_flange_ = result_.order.has_flange_pose;
  T_base_flange_at_capture_ = result_.order.T_base_flange;
  capture_ns_ = result_.capture_ns;
  result_.capture_unix_ns = capture_unix_ns_;
  result_.frame_sequence = frame.sequence;
  if (result_.order.code == OrderCode::kCapture) return end(Cause::kDone);
  return StationState::kComputing;
}

StationState Cycle::compute() {
  Frame frame = frame_.frame();
  if (!recipe_->roi.whole_image()) frame.roi = recipe_->roi;
  result_.capture_ns = capture_ns_;
  result_.capture_unix_ns = capture_unix_ns_;
  result_.frame_sequence = frame.sequence;
  if (refuses(frame)) return end(Cause::kDetectionFailed);
  DetectRequest request;
  request.model_indices = recipe_->models;
  request.modality = recipe_->modality;
  request.near_symmetry = recipe_->near_symmetry;
  request.min_score = recipe_->min_score;
  request.max_results = static_cast<int>(picks_.size());
  request.deadline_ns = deadline_ns_;  // one clock: the detector was made with it
  const std::int64_t before_ns = parts_.clock();
  const Result<DetectionReport> report = parts_.detector.detect(frame, request);
  const std::int64_t after_ns = parts_.clock();
  result_.times.detect_ms = ms_between(before_ns, after_ns);
  if (parts_.progress != nullptr) parts_.progress(parts_.progress_context);
  if (!report.ok()) {
    result_.error = report.error();
    return end(cause_of(report.error().code, false));
  }
  rank(report.value());
  explain(report.value());
  result_.times.rank_ms = ms_between(after_ns, parts_.clock());
  if (!report.value().cut_short) return end(Cause::kDone);
  return end(result_.picks.empty() ? Cause::kDeadlineMissed : Cause::kCutShort);
}

// What can only be a mistake is not searched.
bool Cycle::refuses(const Frame& frame) {
  result_.findings =
      check_frame(frame, {parts_.recipes.models(), recipe_->models, recipe_->modality});
  for (const Finding& finding : result_.findings.found())
    result_.no_pick_reasons |= no_pick_reason_of(finding.code);
  const Finding* refusal = result_.findings.refusal();
  if (refusal == nullptr) return false;
  result_.error = {ErrorCode::kFrameRefused, static_cast<long long>(refusal->code), "frame"};
  return true;
}

int Cycle::wanted_picks() const {
  return result_.order.picks_max > 0 ? result_.order.picks_max : recipe_->picks_max;
}

void Cycle::rank(const DetectionReport& report) {
  const bool in_base = settings_.pose_frame == PoseFrame::kBase;
  result_.pose_frame = settings_.pose_frame;
  const int count =
      rank_picks(report.detections, *recipe_, settings_.ranking, in_base ? T_base_cam() : Pose{},
                 in_base, wanted_picks(), ranking_, picks_);
  result_.picks = picks_.first(static_cast<std::size_t>(count));
  result_.page = 1;
  result_.detections = static_cast<int>(report.detections.size());
  result_.dropped = report.dropped;
  result_.stage_ms = report.stage_ms;
}

Pose Cycle::T_base_cam() const {
  if (settings_.mounting == Mounting::kFixed) return settings_.T_base_cam;
  return T_base_flange_at_capture_ * settings_.T_flange_cam;
}

void Cycle::explain(const DetectionReport& report) {
  std::uint16_t& reasons = result_.no_pick_reasons;
  const auto dropped = [&](DropReason reason) {
    return report.dropped[static_cast<std::size_t>(reason)] > 0;
  };
  if (dropped(DropReason::kBelowMinScore)) reasons |= bit(NoPickReason::kBelowScore);
  if (dropped(DropReason::kTooHidden)) reasons |= bit(NoPickReason::kTooHidden);
  if (dropped(DropReason::kContradicted)) reasons |= bit(NoPickReason::kContradicted);
  if (dropped(DropReason::kPoseDiverged)) reasons |= bit(NoPickReason::kPoseUncertain);
  if (report.cut_short) reasons |= bit(NoPickReason::kDeadline);
  if (dropped(DropReason::kResultLimit) || result_.picks.size() < report.detections.size())
    reasons |= bit(NoPickReason::kLimit);
  if (!result_.picks.empty() || reasons & bit(NoPickReason::kLimit)) return;
  if (reasons == 0) reasons |= bit(NoPickReason::kNothingFound);
}

// The state that the cause leaves the station in.
StationState Cycle::end(Cause cause) {
  result_.cause = cause;
  if (is_fault(cause)) return StationState::kFault;
  if (is_refusal(cause) || !cycles(result_.order.code)) {
    return result_.order.code == OrderCode::kFlush && state() != StationState::kFault
               ? StationState::kIdle
               : state();
  }
  return StationState::kDone;
}

void Cycle::finish(StationState state) {
  const std::int64_t now_ns = parts_.clock();
  result_.times.total_ms = ms_between(result_.order.received_ns, now_ns);
  result_.late = deadline_ns_ != 0 && now_ns > deadline_ns_ && cycles(result_.order.code);
  enter(state);
}

}  // namespace binpick::app
