#include "replay/station_replay.hpp"

#include <algorithm>

#include "clock.hpp"
#include "daemon/answer_of_result.hpp"

namespace binpick::app {
namespace {

namespace map = modbus::map;

// Nothing comes too late in a replay, and nobody has to clear faults.
Config without_time(Config config) {
  config.station.deadline_ms = 0;
  config.station.fault_latched = false;
  config.sensor.frame_deadline_ms = 60000;
  return config;
}

FramePoolParams pool_for(const Config& config) {
  return {2, config.sensor.width_max, config.sensor.height_max};  // the kept frame and the next
}

// Causes that depend on the clock, or on what the station was doing.
bool depends_on_more(Cause cause) {
  switch (cause) {
    case Cause::kCutShort:
    case Cause::kDeadlineMissed:
    case Cause::kBusy:
    case Cause::kInFault:
    case Cause::kFreeRunning:
    case Cause::kNothingCaptured:
    case Cause::kPlcHeartbeatLost:
    case Cause::kInternalFault:
      return true;
    default:
      return false;
  }
}

ErrorCode fault_of(Cause cause) {
  switch (cause) {
    case Cause::kSensorTimeout:
      return ErrorCode::kSensorTimeout;
    case Cause::kFrameDamaged:
      return ErrorCode::kSensorFrameDropped;
    case Cause::kSensorRefused:
      return ErrorCode::kSensorRefused;
    default:
      return ErrorCode::kSensorLost;
  }
}

}  // namespace

Result<FrameRef> StationReplay::Frames::grab(std::chrono::steady_clock::time_point) {
  if (frame_ == nullptr) return Error{fault_, 0, "recorded"};
  const Frame view = frame_->view();
  if (!pool_.fits(view.camera.width, view.camera.height))
    return Error{ErrorCode::kFrameTooLarge, 0, "recorded"};
  FrameRef ref = pool_.try_take();
  BINPICK_ASSERT(ref);
  FrameSlot& slot = ref.slot();
  std::copy(frame_->depth_mm.begin(), frame_->depth_mm.end(), slot.depth_mm.begin());
  std::copy(frame_->intensity.begin(), frame_->intensity.end(), slot.intensity.begin());
  slot.frame = view;
  slot.frame.depth_mm.data = slot.depth_mm.data();
  if (!view.intensity.empty()) slot.frame.intensity.data = slot.intensity.data();
  return ref;
}

StationReplay::StationReplay(const Config& config, const Recording& recording)
    : config_(without_time(config)),
      recipes_(config_),
      pool_params_(pool_for(config_)),
      workers_(config_.threads.workers > 0 ? config_.threads.workers : default_thread_count()),
      arena_(FramePool::footprint(pool_params_) +
             Detector::footprint(recipes_.models(), recipes_.limits(),
                                 {MapLayout::kRearranged, config_.threads.isa},
                                 workers_.thread_count()) +
             Cycle::footprint(config_.station.picks_max)),
      pool_(pool_params_, arena_),
      detector_(recipes_.models(), recipes_.limits(), {MapLayout::kRearranged, config_.threads.isa},
                workers_, monotonic_ns, arena_),
      frames_(pool_),
      cycle_({recipes_, detector_, frames_, monotonic_ns}, settings_of(config_),
             config_.station.picks_max, recipes_.recipes().front().number, arena_) {
  const auto has_frame = [](const RecordedCycle& cycle) { return cycle.image.has_value(); };
  if (std::none_of(recording.cycles.begin(), recording.cycles.end(), has_frame)) return;
  data_.emplace(recording.folder, "test");
  scene_ = data_->scene(1);
}

// As process finds it: captured by the capture that came last.
bool StationReplay::keep_frame(const Order& process) {
  Order capture = captured_;
  capture.code = OrderCode::kCapture;
  capture.recipe = process.recipe;
  return is_done(cycle_.run(capture).cause);
}

std::optional<modbus::AnswerRegisters> StationReplay::run(const RecordedCycle& recorded) {
  if (depends_on_more(recorded.cause)) return std::nullopt;
  const auto conventions = recorded.answer[map::kAddressConventions - map::kAnswerStart];
  const auto encoding = modbus::encoding_of(conventions);
  Order order = order_of_command(recorded.command, encoding.value_or(config_.modbus.encoding),
                                 needs_flange_pose(config_.station), monotonic_ns());
  // Whatever was selected then.
  if (order.recipe == 0) order.recipe = recorded.answer[map::kAddressRecipe - map::kAnswerStart];
  if (recorded.cause != Cause::kDeadlineTooShort) order.deadline_ms = 0;

  drivers::LoadedFrame frame;
  if (recorded.image) frame = data_->load_frame(scene_, *recorded.image);
  frames_.set(recorded.image ? &frame : nullptr, fault_of(recorded.cause));
  if (order.code == OrderCode::kCapture) captured_ = order;
  if (order.code == OrderCode::kProcess && !is_refusal(recorded.cause) && !keep_frame(order))
    return std::nullopt;
  modbus::AnswerSnapshot answer;
  fill_answer(cycle_.run(order), answer);
  frames_.set(nullptr, ErrorCode::kSensorLost);
  modbus::AnswerRegisters registers{};
  modbus::encode_answer(answer, config_.modbus.encoding, registers);
  return registers;
}

std::vector<RegisterDifference> differences(const modbus::AnswerRegisters& recorded,
                                            const modbus::AnswerRegisters& replayed) {
  std::vector<RegisterDifference> found;
  for (const map::NamedRegister& r : map::kAnswerRegisters) {
    if (r.varies) continue;
    RegisterDifference difference{r.name};
    for (int i = 0; i < r.words; ++i) {
      const auto at = static_cast<std::size_t>(r.address - map::kAnswerStart + i);
      difference.recorded = difference.recorded << 16 | recorded[at];
      difference.replayed = difference.replayed << 16 | replayed[at];
    }
    if (difference.recorded != difference.replayed) found.push_back(difference);
  }
  return found;
}

}  // namespace binpick::app
