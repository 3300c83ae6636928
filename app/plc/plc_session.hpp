// A PLC's side of the handshake over one connection: heartbeat, commands, polling. Every read goes
// through the invariants. Thread: one.
#pragma once

#include <functional>
#include <optional>

#include "plc/invariants.hpp"
#include "plc/plc_client.hpp"

namespace binpick::plc {

class PlcSession {
 public:
  // Connects and reads once: sequences go on from those of the station, poses are encoded as it
  // says. Throws app::SetupError, also when this is no station of this map.
  PlcSession(const Target& target, const InvariantLimits& limits, bool with_heartbeat);

  struct Seen {
    modbus::AnswerRegisters registers{};
    modbus::DecodedAnswer decoded;
    std::int64_t begun_ns = 0;
    std::int64_t ended_ns = 0;
  };
  // Nothing when the read was no whole answer; the invariants hold the reason then.
  std::optional<Seen> read();

  // Writes the command block with the next sequence, which it returns.
  std::uint16_t send(modbus::Command command);
  const modbus::CommandRegisters& sent() const { return block_; }
  std::int64_t sent_ns() const { return sent_ns_; }

  // Reads, pausing in between as `pause` says, until the answer to the last command is there, or
  // not in time. `on_read` sees each read.
  std::optional<Seen> wait_for_answer(int timeout_ms, const std::function<void()>& pause,
                                      const std::function<void(const Seen&)>& on_read);

  // Moves the heartbeat when 100 ms have gone by, if there is to be one.
  void beat();

  const Seen& first() const { return *first_; }
  const Invariants& invariants() const { return invariants_; }

 private:
  PlcClient client_;
  Invariants invariants_;
  bool with_heartbeat_;
  std::optional<Seen> first_;
  modbus::CommandRegisters block_{};
  std::uint16_t sequence_ = 0;
  std::int64_t sent_ns_ = 0;
  std::int64_t beat_ns_ = 0;
};

}  // namespace binpick::plc
