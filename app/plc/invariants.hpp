// What must hold of every read of the answer block, and from one read to the next. Fed with each
// read and each command of one client; says what does not hold. Thread: one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modbus/answer.hpp"

namespace binpick::plc {

struct InvariantLimits {
  std::int64_t heartbeat_ms_max = 1000;  // station_heartbeat has to move within this time
  std::int64_t age_tolerance_ms = 100;   // beside the time that a read takes
};

class Invariants {
 public:
  explicit Invariants(const InvariantLimits& limits) : limits_(limits) {}

  // To be called before the command is written.
  void command_sent(std::uint16_t sequence, modbus::map::CommandCode code, std::int64_t now_ns);

  // A read that was begun and ended at these times of the monotonic clock. Returns the answer, or
  // nothing when it was not whole.
  std::optional<modbus::DecodedAnswer> read(const modbus::AnswerRegisters& registers,
                                            std::int64_t begun_ns, std::int64_t ended_ns);

  long long fault_count() const { return fault_count_; }
  // The first ones, as sentences.
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  struct Read {
    modbus::AnswerRegisters registers{};
    modbus::DecodedAnswer decoded;
    std::int64_t begun_ns = 0;
    std::int64_t ended_ns = 0;
  };

  void fault(const std::string& text);
  void check_sequences(const Read& now);
  void check_latched(const Read& now);
  void check_heartbeat(const Read& now);
  void check_age(const Read& now);
  void check_fresh(const Read& now);

  InvariantLimits limits_;
  std::optional<Read> last_;
  std::int64_t heartbeat_moved_ns_ = 0;
  std::uint16_t sent_sequence_ = 0;
  modbus::map::CommandCode sent_code_ = modbus::map::CommandCode::kNone;
  std::int64_t sent_ns_ = 0;
  long long fault_count_ = 0;
  std::vector<std::string> faults_;
};

}  // namespace binpick::plc
