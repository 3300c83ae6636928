// Answers of which every register is a function of one number: whoever reads one can tell whether
// it is whole.
#pragma once

#include "modbus/answer.hpp"

namespace binpick::modbus {

// The answer number `n`: its picks' count, poses and scores follow from n, as do its sequences.
inline AnswerSnapshot fake_answer(std::uint32_t n) {
  AnswerSnapshot answer;
  answer.result_sequence = static_cast<std::uint16_t>(n % 65535 + 1);
  answer.result_command = static_cast<std::uint16_t>(n);
  answer.acknowledged_sequence = static_cast<std::uint16_t>(n);
  answer.station_heartbeat = static_cast<std::uint16_t>(n * 3);
  answer.cause = map::Cause::kDone;
  answer.detections = static_cast<std::uint16_t>(n * 7);
  answer.page_pick_count = static_cast<int>(n % 7);
  answer.picks = static_cast<std::uint16_t>(n % 7);
  answer.page = 1;
  answer.recipe = static_cast<std::uint16_t>(n % 100);
  answer.cycle_number = n;
  answer.capture_unix_ms = 1'700'000'000'000 + n;
  answer.cycle_time_ms = n % 1000;
  for (int i = 0; i < answer.page_pick_count; ++i) {
    Pick& pick = answer.page_picks[static_cast<std::size_t>(i)];
    pick.T_ref_part.t_mm = {n * 0.001, i * 1.0, -(n * 0.001)};
    pick.score = (n % 10000) * 1e-4;
    pick.visible = 1 - pick.score;
    pick.recipe = answer.recipe;
  }
  return answer;
}

// Whether all that `read` shows belongs to the answer whose number it tells.
inline bool is_whole(const AnswerRegisters& read, const Encoding& encoding) {
  const auto decoded = decode_answer(read);
  if (!decoded) return false;
  AnswerRegisters expected;
  encode_answer(fake_answer(decoded->answer.cycle_number), encoding, expected);
  put_age(expected, encoding.word_order, decoded->age_ms);  // the one that time changes
  return expected == read;
}

}  // namespace binpick::modbus
