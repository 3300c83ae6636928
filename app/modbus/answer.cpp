#include "modbus/answer.hpp"

#include <algorithm>

#include "binpick/base/assert.hpp"
#include "modbus/registers.hpp"

namespace binpick::modbus {
namespace {

constexpr double kUnitScale = 1e4;  // score and visible fraction: 0.0001
constexpr auto kValidPick = static_cast<std::uint16_t>(map::PickFlagsBit::kValid);

constexpr std::size_t index_of(int address) {
  return static_cast<std::size_t>(address - map::kAnswerStart);
}

constexpr std::size_t pick_index(int pick) {
  return index_of(map::kPicksStart + pick * map::kPickSize);
}

void encode_pick(const Pick& pick, const Encoding& encoding, std::span<std::uint16_t> words) {
  // A pose that is none leaves the pick without its valid flag, and all zeros.
  if (!put_pose(words, encoding, pick.T_ref_part)) return;
  words[map::kPickScore] = rounded_uint16(pick.score * kUnitScale);
  words[map::kPickRecipe] = pick.recipe;
  words[map::kPickVisible] = rounded_uint16(pick.visible * kUnitScale);
  words[map::kPickFlags] = pick.flags | kValidPick;
}

void encode_identity(const Encoding& encoding, AnswerRegisters& r) {
  const map::WordOrder order = encoding.word_order;
  const auto at = [&](int address) { return std::span(r).subspan(index_of(address)); };
  r[index_of(map::kAddressMapVersion)] = map::kVersion;
  r[index_of(map::kAddressMapChecksum)] = map::kChecksum;
  put_uint32(at(map::kAddressTestUint32), order, map::kTestUint32);
  put_float32(at(map::kAddressTestFloat32), order, map::kTestFloat32);
  r[index_of(map::kAddressTestInt16)] = static_cast<std::uint16_t>(map::kTestInt16);
  r[index_of(map::kAddressConventions)] = conventions_word(encoding);
}

bool identity_holds(std::span<const std::uint16_t> r, map::WordOrder order) {
  return r[index_of(map::kAddressMapVersion)] == map::kVersion &&
         r[index_of(map::kAddressMapChecksum)] == map::kChecksum &&
         get_uint32(r.subspan(index_of(map::kAddressTestUint32)), order) == map::kTestUint32 &&
         get_float32(r.subspan(index_of(map::kAddressTestFloat32)), order) == map::kTestFloat32 &&
         r[index_of(map::kAddressTestInt16)] == static_cast<std::uint16_t>(map::kTestInt16);
}

}  // namespace

void encode_answer(const AnswerSnapshot& a, const Encoding& encoding, AnswerRegisters& r) {
  BINPICK_ASSERT(a.page_pick_count >= 0 && a.page_pick_count <= map::kPicksPerPage);
  r.fill(0);
  encode_identity(encoding, r);
  const map::WordOrder order = encoding.word_order;
  const auto at = [&](int address) { return std::span(r).subspan(index_of(address)); };
  r[index_of(map::kAddressState)] = a.state;
  r[index_of(map::kAddressStationHeartbeat)] = a.station_heartbeat;
  r[index_of(map::kAddressAcknowledgedSequence)] = a.acknowledged_sequence;
  r[index_of(map::kAddressResultSequence)] = a.result_sequence;
  r[index_of(map::kAddressResultCommand)] = a.result_command;
  r[index_of(map::kAddressCause)] = static_cast<std::uint16_t>(a.cause);
  r[index_of(map::kAddressNoPickReasons)] = a.no_pick_reasons;
  r[index_of(map::kAddressDetections)] = a.detections;
  const int page_picks = shows_picks(a.cause) ? a.page_pick_count : 0;
  if (shows_picks(a.cause)) {
    r[index_of(map::kAddressPicks)] = a.picks;
    r[index_of(map::kAddressPage)] = a.page;
    r[index_of(map::kAddressPagePicks)] = static_cast<std::uint16_t>(page_picks);
  }
  r[index_of(map::kAddressRecipe)] = a.recipe;
  put_uint32(at(map::kAddressCycleNumber), order, a.cycle_number);
  const std::int64_t unix_ms = std::max<std::int64_t>(a.capture_unix_ms, 0);
  put_uint32(at(map::kAddressCaptureTime), order, static_cast<std::uint32_t>(unix_ms / 1000));
  r[index_of(map::kAddressCaptureTimeMs)] = static_cast<std::uint16_t>(unix_ms % 1000);
  put_age(r, order, kAgeNone);
  r[index_of(map::kAddressCycleTime)] = rounded_uint16(static_cast<double>(a.cycle_time_ms));
  for (int i = 0; i < page_picks; ++i) {
    encode_pick(a.page_picks[static_cast<std::size_t>(i)], encoding,
                std::span(r).subspan(pick_index(i), map::kPickSize));
  }
  r[index_of(map::kAddressResultSequenceTail)] = a.result_sequence;
}

void put_age(std::span<std::uint16_t> registers, map::WordOrder order, std::uint32_t age_ms) {
  put_uint32(registers.subspan(index_of(map::kAddressAge)), order, age_ms);
}

std::optional<DecodedAnswer> decode_answer(std::span<const std::uint16_t> r) {
  if (r.size() != map::kAnswerCount) return {};
  const auto encoding = encoding_of(r[index_of(map::kAddressConventions)]);
  if (!encoding || !identity_holds(r, encoding->word_order)) return {};
  const map::WordOrder order = encoding->word_order;
  const auto at = [&](int address) { return r[index_of(address)]; };
  const auto long_at = [&](int address) { return get_uint32(r.subspan(index_of(address)), order); };
  DecodedAnswer decoded{.answer = {}, .encoding = *encoding, .age_ms = long_at(map::kAddressAge)};
  AnswerSnapshot& a = decoded.answer;
  a.state = at(map::kAddressState);
  a.station_heartbeat = at(map::kAddressStationHeartbeat);
  a.acknowledged_sequence = at(map::kAddressAcknowledgedSequence);
  a.result_sequence = at(map::kAddressResultSequence);
  a.result_command = at(map::kAddressResultCommand);
  a.cause = static_cast<map::Cause>(at(map::kAddressCause));
  a.no_pick_reasons = at(map::kAddressNoPickReasons);
  a.detections = at(map::kAddressDetections);
  a.picks = at(map::kAddressPicks);
  a.page = at(map::kAddressPage);
  a.page_pick_count = at(map::kAddressPagePicks);
  a.recipe = at(map::kAddressRecipe);
  a.cycle_number = long_at(map::kAddressCycleNumber);
  a.capture_unix_ms = std::int64_t{1000} * long_at(map::kAddressCaptureTime);
  a.capture_unix_ms += at(map::kAddressCaptureTimeMs);
  a.cycle_time_ms = at(map::kAddressCycleTime);
  if (a.result_sequence != at(map::kAddressResultSequenceTail)) return {};
  if (!shows_picks(a.cause) && a.picks != 0) return {};
  if (a.page_pick_count > map::kPicksPerPage || a.page_pick_count > a.picks) return {};
  for (int i = 0; i < a.page_pick_count; ++i) {
    const auto words = r.subspan(pick_index(i), map::kPickSize);
    const auto pose = get_pose(words, *encoding);
    if (!pose || (words[map::kPickFlags] & kValidPick) == 0) return {};
    a.page_picks[static_cast<std::size_t>(i)] = {.T_ref_part = *pose,
                                                 .score = words[map::kPickScore] / kUnitScale,
                                                 .visible = words[map::kPickVisible] / kUnitScale,
                                                 .recipe = words[map::kPickRecipe],
                                                 .flags = words[map::kPickFlags]};
  }
  return decoded;
}

}  // namespace binpick::modbus
