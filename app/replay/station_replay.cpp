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

bool grabs(OrderCode code) {
  return code == OrderCode::kDetect || code == OrderCode::kCapture;
}

ErrorCode fault_of(Cause cause) {
  switch (cause) {
    case Cause::kSensorTimeout:
      return ErrorCode::kSensorTimeout;
    case Cause::kFrameDamaged:
      return ErrorCode::kSensorFrameDropped;
    case Cause::kSensorRefused:
      return ErrorCode::kSensorRefused;
    case Cause::kDetectionFailed:  // without a frame: it did not fit
      return ErrorCode::kFrameTooLarge;
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
  if (!view.depth_mm.empty()) slot.frame.depth_mm.data = slot.depth_mm.data();
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

// As process finds it.
bool StationReplay::keep_frame(const Order& process) {
  Order capture = captured_.value_or(Order{});
  capture.code = OrderCode::kCapture;
  capture.recipe = process.recipe;
  capture.refusal = Cause::kDone;
  return is_done(cycle_.run(capture).cause);
}

Order StationReplay::order_of(const RecordedCycle& recorded) {
  const auto conventions = recorded.answer[map::kAddressConventions - map::kAnswerStart];
  const auto encoding = modbus::encoding_of(conventions);
  Order order = order_of_command(recorded.command, encoding.value_or(config_.modbus.encoding),
                                 needs_flange_pose(config_.station), monotonic_ns());
  if (recorded.cause != Cause::kDeadlineTooShort) order.deadline_ms = 0;
  // Refused for what the station was doing: so that it is refused here too.
  if (is_refusal(recorded.cause) && depends_on_more(recorded.cause)) order.refusal = recorded.cause;
  if (recorded.recipe_selected == 0) {  // whatever was selected then
    if (order.recipe == 0) order.recipe = recorded.answer[map::kAddressRecipe - map::kAnswerStart];
  } else if (order.code != OrderCode::kSelectRecipe) {
    Order select;
    select.code = OrderCode::kSelectRecipe;
    select.recipe = recorded.recipe_selected;
    if (cycle_.selected_recipe() != select.recipe) cycle_.run(select);
  }
  return order;
}

const char* StationReplay::why_not_comparable(const RecordedCycle& recorded,
                                              const Order& order) const {
  if (depends_on_more(recorded.cause)) return cause_name(recorded.cause);
  const bool cycle = grabs(order.code) || order.code == OrderCode::kProcess;
  if (cycle && !is_refusal(recorded.cause)) {
    const bool needs_capture =
        order.code == OrderCode::kProcess && needs_flange_pose(config_.station);
    return needs_capture && !captured_ ? "its capture is not in the recording" : nullptr;
  }
  return in_step_ ? nullptr : "what came before it is not in the recording, or was not comparable";
}

// After it was carried out: whether the next one finds what it found in the station.
void StationReplay::follow(const RecordedCycle& recorded, const Order& order) {
  if (grabs(order.code) && !is_refusal(recorded.cause)) captured_ = order;
  const bool cycle = grabs(order.code) || order.code == OrderCode::kProcess;
  if (cycle && !is_refusal(recorded.cause)) in_step_ = !depends_on_more(recorded.cause);
  cycle_.set_free_running(false);  // its cycles are recorded as orders
}

StationReplay::Answer StationReplay::run(const RecordedCycle& recorded) {
  if (recorded.record != last_record_ + 1 && recorded.record != 0) {
    in_step_ = false;
    captured_.reset();
  }
  last_record_ = recorded.record;
  Order order = order_of(recorded);
  Answer answer;
  answer.not_comparable = why_not_comparable(recorded, order);
  drivers::LoadedFrame frame;
  if (recorded.image) frame = data_->load_frame(scene_, *recorded.image);
  frames_.set(recorded.image ? &frame : nullptr, fault_of(recorded.cause));
  const bool processes = order.code == OrderCode::kProcess && !is_refusal(recorded.cause);
  if (processes && !keep_frame(order)) answer.not_comparable = "its frame cannot be kept";
  modbus::AnswerSnapshot snapshot;
  fill_answer(cycle_.run(order), snapshot);
  frames_.set(nullptr, ErrorCode::kSensorLost);
  modbus::encode_answer(snapshot, config_.modbus.encoding, answer.registers);
  follow(recorded, order);
  return answer;
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
