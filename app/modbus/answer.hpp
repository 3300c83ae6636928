// The answer block: a result as the station knows it, and its 125 registers. Knows nothing of
// detection or sensors: numbers in, registers out. Thread-safe: no state.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "binpick/geometry/pose.hpp"
#include "modbus/encoding.hpp"
#include "modbus/register_map.hpp"

namespace binpick::modbus {

using AnswerRegisters = std::array<std::uint16_t, map::kAnswerCount>;

struct Pick {
  Pose T_ref_part;     // to the frame in which picks are published: robot base or camera
  double score = 0;    // 0 to 1
  double visible = 0;  // 0 to 1
  std::uint16_t recipe = 0;
  std::uint16_t flags = 0;  // bits of map::PickFlagsBit; `valid` is set by the encoder
};

// Everything that one read shows, but its age: that is reckoned when it is read.
struct AnswerSnapshot {
  std::uint16_t state = 0;  // bits of map::StateBit
  std::uint16_t station_heartbeat = 0;
  std::uint16_t acknowledged_sequence = 0;
  std::uint16_t result_sequence = 0;
  std::uint16_t result_command = 0;
  map::Cause cause = map::Cause::kNoResult;
  std::uint16_t no_pick_reasons = 0;  // bits of map::NoPickReasonsBit
  std::uint16_t detections = 0;
  std::uint16_t picks = 0;  // on all pages
  std::uint16_t page = 0;   // from 1; 0: none
  std::uint16_t recipe = 0;
  std::uint32_t cycle_number = 0;
  std::int64_t capture_unix_ms = 0;  // 0: none
  std::int64_t cycle_time_ms = 0;
  std::array<Pick, map::kPicksPerPage> page_picks;
  int page_pick_count = 0;
};

// The sequence that follows: 0 is left out, it means "none".
constexpr std::uint16_t next_sequence(std::uint16_t sequence) {
  return sequence == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(sequence + 1);
}

// The number of pages that `picks` take; at least one, so that an empty result can be shown.
constexpr int page_count(int picks) {
  return picks <= 0 ? 1 : (picks + map::kPicksPerPage - 1) / map::kPicksPerPage;
}

// A command that was refused or failed shows no picks, whatever the snapshot holds: nobody may take
// those of an earlier answer for its own.
constexpr bool shows_picks(map::Cause cause) {
  return static_cast<int>(cause) < 100;
}

// Writes all registers; age is written as "no frame yet" and is the server's business.
void encode_answer(const AnswerSnapshot& answer, const Encoding& encoding,
                   AnswerRegisters& registers);

// age_ms into the block, held below the number that means "no frame yet".
inline constexpr std::uint32_t kAgeNone = 0xFFFFFFFF;
void put_age(std::span<std::uint16_t> registers, map::WordOrder order, std::uint32_t age_ms);

// The other way, for the simulator of a PLC and for tests; the block's own conventions are used.
struct DecodedAnswer {
  AnswerSnapshot answer;
  Encoding encoding;
  std::uint32_t age_ms = kAgeNone;
};
// Empty when constants, conventions, sequences or counts are not those of one whole answer.
std::optional<DecodedAnswer> decode_answer(std::span<const std::uint16_t> registers);

}  // namespace binpick::modbus
