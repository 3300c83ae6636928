#include "fake_station.hpp"

#include <algorithm>
#include <chrono>

#include "clock.hpp"

namespace binpick::modbus {
namespace {

using map::Cause;
using map::CommandCode;
using map::StateBit;

constexpr CommandLimits kLimits{.recipe_count = 3, .picks_max = 24, .deadline_ms_min = 1};
constexpr int kHeartbeatMs = 50;

std::int64_t unix_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

std::uint16_t bits(std::initializer_list<StateBit> set) {
  unsigned word = 0;
  for (const StateBit bit : set) word |= static_cast<unsigned>(bit);
  return static_cast<std::uint16_t>(word);
}

void sleep_ms(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

}  // namespace

FakeStation::FakeStation(const FakeStationConfig& config)
    : config_(config), server_(config.server, config.encoding, image_, inbox_) {
  answer_.recipe = 1;
  publish();
  server_.start();
  thread_ = std::thread([this] { run(); });
}

FakeStation::~FakeStation() {
  stopping_ = true;
  thread_.join();
  server_.stop();
}

void FakeStation::run() {
  while (!stopping_) {
    TakenCommand taken;
    if (inbox_.wait(taken, free_running_ ? 0 : kHeartbeatMs)) {
      carry_out(decode_command(taken.registers, kLimits, config_.encoding), taken.taken_ns);
    } else if (free_running_) {
      const std::int64_t begin_ns = app::monotonic_ns();
      take_frame();
      find_parts({});
      finish(0, Cause::kDone, begin_ns);
    } else {
      publish();
    }
  }
}

void FakeStation::carry_out(const Command& command, std::int64_t taken_ns) {
  answer_.acknowledged_sequence = command.sequence;
  answer_.state |= bits({StateBit::kBusy});
  publish();
  const Cause cause = command.refusal != Cause::kDone ? command.refusal : result_of(command);
  finish(command.sequence, cause, taken_ns);
}

Cause FakeStation::result_of(const Command& command) {
  switch (command.code) {
    case CommandCode::kDetect:
      if (!config_.answers_stale || capture_ns_ == 0) take_frame();
      find_parts(command);
      return Cause::kDone;
    case CommandCode::kCapture:
      take_frame();
      frame_kept_ = true;
      return Cause::kDone;
    case CommandCode::kProcess:
      if (!frame_kept_) return Cause::kNothingCaptured;
      find_parts(command);
      return Cause::kDone;
    case CommandCode::kSelectRecipe:
      answer_.recipe = static_cast<std::uint16_t>(command.recipe);
      return Cause::kDone;
    case CommandCode::kNextPage:
    case CommandCode::kPage: {
      if (answer_.page == 0) return Cause::kNothingToPage;
      const int page = command.code == CommandCode::kPage ? command.page : answer_.page + 1;
      if (page > page_count(picks_)) return Cause::kPageUnknown;
      show_page(page);
      return Cause::kDone;
    }
    case CommandCode::kFreeRunStart:
    case CommandCode::kFreeRunStop:
      free_running_ = command.code == CommandCode::kFreeRunStart;
      return Cause::kDone;
    case CommandCode::kFlush:
      frame_kept_ = false;
      picks_ = 0;
      answer_.page_pick_count = 0;
      answer_.page = 0;
      return Cause::kDone;
    case CommandCode::kNone:
    case CommandCode::kClearFault:
      return Cause::kDone;
  }
  return Cause::kCommandUnknown;
}

void FakeStation::take_frame() {
  capture_ns_ = app::monotonic_ns();
  answer_.capture_unix_ms = unix_ms();
}

// Cycles find 0 to 15 parts, so that empty results and further pages come up.
void FakeStation::find_parts(const Command& command) {
  sleep_ms(config_.cycle_ms);
  ++answer_.cycle_number;
  const int found = static_cast<int>(answer_.cycle_number * 5 % 16);
  picks_ = command.picks_max > 0 ? std::min(found, command.picks_max) : found;
  answer_.detections = static_cast<std::uint16_t>(found);
  if (command.recipe > 0) answer_.recipe = static_cast<std::uint16_t>(command.recipe);
  show_page(1);
}

void FakeStation::show_page(int page) {
  answer_.page = static_cast<std::uint16_t>(page);
  const int first = (page - 1) * map::kPicksPerPage;
  answer_.page_pick_count = std::clamp(picks_ - first, 0, map::kPicksPerPage);
  for (int i = 0; i < answer_.page_pick_count; ++i) {
    Pick& pick = answer_.page_picks[static_cast<std::size_t>(i)];
    const double n = first + i;
    pick.T_ref_part.t_mm = {100 + n, -50.5 - n, 600 + 0.001 * answer_.cycle_number};
    pick.T_ref_part.R = rotation_from_vector({0.1 * n, 0.2, -0.3});
    pick.score = 0.95 - 0.01 * n;
    pick.visible = 0.9;
    pick.recipe = answer_.recipe;
  }
}

void FakeStation::finish(std::uint16_t result_command, Cause cause, std::int64_t taken_ns) {
  answer_.result_sequence = next_sequence(answer_.result_sequence);
  answer_.result_command = result_command;
  answer_.cause = cause;
  answer_.picks = static_cast<std::uint16_t>(picks_);
  const bool empty = cause == Cause::kDone && picks_ == 0;
  answer_.no_pick_reasons =
      empty ? static_cast<std::uint16_t>(map::NoPickReasonsBit::kNothingFound) : std::uint16_t{0};
  answer_.cycle_time_ms = (app::monotonic_ns() - taken_ns) / 1'000'000;
  answer_.state = bits({StateBit::kResultValid});
  publish();
}

void FakeStation::publish() {
  const unsigned kept = answer_.state & bits({StateBit::kBusy, StateBit::kResultValid});
  unsigned now = bits({StateBit::kReady, StateBit::kSensorOk, StateBit::kSimulated});
  if (free_running_) now |= bits({StateBit::kFreeRunning});
  if (answer_.result_command == answer_.acknowledged_sequence && answer_.result_sequence != 0) {
    now |= bits({StateBit::kResultCurrent});
  }
  if (server_.plc_heartbeat() == Heartbeat::kLost) now |= bits({StateBit::kPlcHeartbeatLost});
  answer_.state = static_cast<std::uint16_t>(kept | now);
  if (!config_.heartbeat_stands) ++answer_.station_heartbeat;
  if (config_.changes_picks) answer_.detections ^= answer_.station_heartbeat & 1U;
  AnswerRegisters registers;
  encode_answer(answer_, config_.encoding, registers);
  if (config_.tail_differs && answer_.cycle_number > 3) --registers.back();
  image_.publish(registers, capture_ns_);
}

}  // namespace binpick::modbus
