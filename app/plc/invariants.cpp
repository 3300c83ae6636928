#include "plc/invariants.hpp"

#include <algorithm>

#include "plc/answer_text.hpp"

namespace binpick::plc {
namespace {

namespace map = modbus::map;

constexpr std::size_t kFaultsKept = 20;

bool has(std::uint16_t state, map::StateBit bit) {
  return (state & static_cast<std::uint16_t>(bit)) != 0;
}

// The registers that one result fixes: all but those that tell how it is now.
modbus::AnswerRegisters of_result(modbus::AnswerRegisters registers) {
  for (const int address :
       {map::kAddressState, map::kAddressStationHeartbeat, map::kAddressAcknowledgedSequence,
        map::kAddressAge, map::kAddressAge + 1}) {
    registers[static_cast<std::size_t>(address - map::kAnswerStart)] = 0;
  }
  return registers;
}

}  // namespace

void Invariants::command_sent(std::uint16_t sequence, map::CommandCode code, std::int64_t now_ns) {
  sent_sequence_ = sequence;
  sent_code_ = code;
  sent_ns_ = now_ns;
}

std::optional<modbus::DecodedAnswer> Invariants::read(const modbus::AnswerRegisters& registers,
                                                      std::int64_t begun_ns,
                                                      std::int64_t ended_ns) {
  const auto decoded = modbus::decode_answer(registers);
  if (!decoded) {
    fault("no whole answer: " + why_not_whole(registers));
    return {};
  }
  const Read now{registers, *decoded, begun_ns, ended_ns};
  check_heartbeat(now);
  if (last_) {
    check_sequences(now);
    check_latched(now);
    check_age(now);
    check_fresh(now);
  }
  last_ = now;
  return decoded;
}

void Invariants::fault(const std::string& text) {
  ++fault_count_;
  if (faults_.size() < kFaultsKept) faults_.push_back(text);
}

void Invariants::check_sequences(const Read& now) {
  const modbus::AnswerSnapshot& a = now.decoded.answer;
  const modbus::AnswerSnapshot& before = last_->decoded.answer;
  const bool free_running =
      has(a.state, map::StateBit::kFreeRunning) || has(before.state, map::StateBit::kFreeRunning);
  const bool step = a.result_sequence == before.result_sequence ||
                    a.result_sequence == modbus::next_sequence(before.result_sequence);
  if (!step && !free_running) {
    fault("result_sequence went from " + std::to_string(before.result_sequence) + " to " +
          std::to_string(a.result_sequence));
  }
  if (a.acknowledged_sequence != before.acknowledged_sequence &&
      a.acknowledged_sequence != sent_sequence_) {
    fault("acknowledged_sequence " + std::to_string(a.acknowledged_sequence) +
          " was not sent: is " + "another PLC writing?");
  }
  if (a.result_sequence != before.result_sequence && a.result_command != 0 &&
      a.result_command != a.acknowledged_sequence) {
    fault("answer to command " + std::to_string(a.result_command) + " came, but " +
          std::to_string(a.acknowledged_sequence) + " is acknowledged");
  }
}

void Invariants::check_latched(const Read& now) {
  if (now.decoded.answer.result_sequence != last_->decoded.answer.result_sequence) return;
  const auto before = of_result(last_->registers);
  const auto after = of_result(now.registers);
  const auto [a, b] = std::mismatch(before.begin(), before.end(), after.begin());
  if (a == before.end()) return;
  const int address = map::kAnswerStart + static_cast<int>(a - before.begin());
  fault("register " + address_text(address) + " went from " + std::to_string(*a) + " to " +
        std::to_string(*b) + " with result_sequence the same: not latched");
}

void Invariants::check_heartbeat(const Read& now) {
  if (!last_ || now.decoded.answer.station_heartbeat != last_->decoded.answer.station_heartbeat) {
    heartbeat_moved_ns_ = now.ended_ns;
    return;
  }
  const std::int64_t still_ms = (now.begun_ns - heartbeat_moved_ns_) / 1'000'000;
  if (still_ms <= limits_.heartbeat_ms_max) return;
  fault("station_heartbeat stands still since " + std::to_string(still_ms) + " ms");
  heartbeat_moved_ns_ = now.ended_ns;  // once a standstill, not once a read
}

// While the frame is the same, age grows as time does.
void Invariants::check_age(const Read& now) {
  const modbus::DecodedAnswer& before = last_->decoded;
  const bool same_frame = now.decoded.answer.capture_unix_ms == before.answer.capture_unix_ms;
  const bool none = now.decoded.age_ms == modbus::kAgeNone;
  if (none != (now.decoded.answer.capture_unix_ms == 0)) {
    fault("age and capture_time disagree on whether there is a frame");
  }
  if (none || !same_frame || before.age_ms == modbus::kAgeNone) return;
  const std::int64_t grown_ms = std::int64_t{now.decoded.age_ms} - before.age_ms;
  const std::int64_t least_ms = (now.begun_ns - last_->ended_ns) / 1'000'000;
  const std::int64_t most_ms = (now.ended_ns - last_->begun_ns) / 1'000'000;
  if (grown_ms < least_ms - limits_.age_tolerance_ms ||
      grown_ms > most_ms + limits_.age_tolerance_ms) {
    fault("age grew by " + std::to_string(grown_ms) + " ms in " + std::to_string(most_ms) + " ms");
  }
}

// The answer to detect shows a frame that was taken after the command was sent.
void Invariants::check_fresh(const Read& now) {
  const modbus::AnswerSnapshot& a = now.decoded.answer;
  const bool is_new = a.result_sequence != last_->decoded.answer.result_sequence;
  const bool takes_frame =
      sent_code_ == map::CommandCode::kDetect || sent_code_ == map::CommandCode::kCapture;
  const bool carried_out = a.cause == map::Cause::kDone || a.cause == map::Cause::kCutShort;
  if (!is_new || !takes_frame || !carried_out || a.result_command != sent_sequence_) return;
  const std::int64_t since_ms = (now.ended_ns - sent_ns_) / 1'000'000;
  if (now.decoded.age_ms > since_ms + limits_.age_tolerance_ms) {
    fault("stale: the frame is " + std::to_string(now.decoded.age_ms) +
          " ms old, the command was sent " + std::to_string(since_ms) + " ms ago");
  }
}

}  // namespace binpick::plc
