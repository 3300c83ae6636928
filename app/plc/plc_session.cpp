#include "plc/plc_session.hpp"

#include "clock.hpp"
#include "plc/answer_text.hpp"
#include "setup_error.hpp"

namespace binpick::plc {
namespace {

constexpr std::int64_t kBeatNs = 100'000'000;

}  // namespace

PlcSession::PlcSession(const Target& target, const InvariantLimits& limits, bool with_heartbeat)
    : client_(target), invariants_(limits), with_heartbeat_(with_heartbeat) {
  first_.emplace();
  first_->begun_ns = app::monotonic_ns();
  client_.read_answer(first_->registers);
  first_->ended_ns = app::monotonic_ns();
  const auto decoded = invariants_.read(first_->registers, first_->begun_ns, first_->ended_ns);
  if (!decoded) throw app::SetupError(why_not_whole(first_->registers));
  first_->decoded = *decoded;
  sequence_ = decoded->answer.acknowledged_sequence;
}

std::optional<PlcSession::Seen> PlcSession::read() {
  Seen seen;
  seen.begun_ns = app::monotonic_ns();
  client_.read_answer(seen.registers);
  seen.ended_ns = app::monotonic_ns();
  const auto decoded = invariants_.read(seen.registers, seen.begun_ns, seen.ended_ns);
  if (!decoded) return {};
  seen.decoded = *decoded;
  return seen;
}

std::uint16_t PlcSession::send(modbus::Command command) {
  sequence_ = modbus::next_sequence(sequence_);
  command.sequence = sequence_;
  modbus::encode_command(command, first_->decoded.encoding, block_);
  if (with_heartbeat_) ++block_[modbus::map::kAddressPlcHeartbeat];
  sent_ns_ = beat_ns_ = app::monotonic_ns();
  invariants_.command_sent(sequence_, command.code, sent_ns_);
  client_.write_command(block_);
  return sequence_;
}

void PlcSession::beat() {
  const std::int64_t now_ns = app::monotonic_ns();
  if (!with_heartbeat_ || now_ns - beat_ns_ < kBeatNs) return;
  beat_ns_ = now_ns;
  client_.write_heartbeat(++block_[modbus::map::kAddressPlcHeartbeat]);
}

std::optional<PlcSession::Seen> PlcSession::wait_for_answer(
    int timeout_ms, const std::function<void()>& pause,
    const std::function<void(const Seen&)>& on_read) {
  const std::int64_t end_ns = sent_ns_ + std::int64_t{timeout_ms} * 1'000'000;
  while (true) {
    const bool last_try = app::monotonic_ns() > end_ns;
    const auto seen = read();
    if (seen) {
      on_read(*seen);
      const modbus::AnswerSnapshot& a = seen->decoded.answer;
      const bool answered = a.result_command == sequence_ && a.acknowledged_sequence == sequence_;
      if (answered) return seen;
    }
    if (last_try) return {};
    beat();
    pause();
  }
}

}  // namespace binpick::plc
