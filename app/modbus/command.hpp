// The command block: from registers to a command with its parameters judged. Thread-safe: no state,
// but for CommandBlock, which belongs to the server's thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "binpick/geometry/pose.hpp"
#include "modbus/encoding.hpp"
#include "modbus/register_map.hpp"

namespace binpick::modbus {

using CommandRegisters = std::array<std::uint16_t, map::kCommandCount>;

// A command as it was when its sequence changed.
struct TakenCommand {
  CommandRegisters registers{};
  std::int64_t taken_ns = 0;  // monotonic clock
};

// What the station can do; a command beyond it is refused with a cause.
struct CommandLimits {
  int recipe_count = 0;
  int picks_max = 0;
  int deadline_ms_min = 0;
  bool flange_pose_needed = false;  // the sensor is on the arm
};

struct Command {
  std::uint16_t sequence = 0;
  map::CommandCode code = map::CommandCode::kNone;
  int recipe = 0;                          // from 1; 0: the one in use
  int picks_max = 0;                       // 0: the recipe's own
  int deadline_ms = 0;                     // 0: the configured one
  int page = 0;                            // from 1
  std::optional<Pose> T_base_flange = {};  // only where one is needed
  map::Cause refusal = map::Cause::kDone;  // kDone: may be carried out
};

// Never fails: what cannot be carried out says so in `refusal`.
Command decode_command(const CommandRegisters& registers, const CommandLimits& limits,
                       const Encoding& encoding);

// The other way, for the simulator of a PLC and for tests. The heartbeat is left alone.
void encode_command(const Command& command, const Encoding& encoding, CommandRegisters& registers);

// Says after each write whether it started a command. Writes that do not change command_sequence
// start nothing, whatever else they change.
class CommandBlock {
 public:
  bool starts(std::span<const std::uint16_t> registers) {
    const std::uint16_t sequence = registers[map::kAddressCommandSequence - map::kCommandStart];
    if (sequence == sequence_) return false;
    sequence_ = sequence;
    return sequence != 0;
  }

 private:
  std::uint16_t sequence_ = 0;
};

}  // namespace binpick::modbus
