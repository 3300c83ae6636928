#include "plc/answer_text.hpp"

#include <cstdio>
#include <iterator>

#include "modbus/registers.hpp"
#include "modbus/rotation.hpp"
#include "setup_error.hpp"

namespace binpick::plc {
namespace {

namespace map = modbus::map;

template <std::size_t n>
std::string name_in(const map::NamedValue (&names)[n], unsigned value) {
  for (const map::NamedValue& known : names) {
    if (known.value == value) return known.name;
  }
  return std::to_string(value);
}

template <std::size_t n>
std::string bits_in(const map::NamedValue (&names)[n], unsigned word) {
  std::string text;
  for (const map::NamedValue& known : names) {
    if ((word & known.value) != 0) text += (text.empty() ? "" : ", ") + std::string(known.name);
  }
  return text.empty() ? "none" : text;
}

std::uint16_t at(const modbus::AnswerRegisters& registers, int address) {
  return registers[static_cast<std::size_t>(address - map::kAnswerStart)];
}

// Where the two words of the test number stand, as an offset to where they belong; or 1000.
int shift_of_constants(const modbus::AnswerRegisters& r) {
  for (int shift = -2; shift <= 20; ++shift) {
    const int address = map::kAddressTestUint32 + shift;
    const unsigned pair = static_cast<unsigned>(at(r, address)) << 16U | at(r, address + 1);
    for (const unsigned word : {0x12345678U, 0x56781234U, 0x34127856U, 0x78563412U}) {
      if (pair == word) return shift;
    }
  }
  return 1000;
}

void line(int address, const char* name, const std::string& value) {
  std::printf("  %-12s %-24s %s\n", address_text(address).c_str(), name, value.c_str());
}

void line(int address, const char* name, long long value) {
  line(address, name, std::to_string(value));
}

}  // namespace

std::string name_of(map::Cause cause) {
  return name_in(map::kCauseNames, static_cast<unsigned>(cause));
}

std::string name_of(map::CommandCode code) {
  return name_in(map::kCommandCodeNames, static_cast<unsigned>(code));
}

std::string state_text(std::uint16_t state) {
  return bits_in(map::kStateBitNames, state);
}

std::string reasons_text(std::uint16_t no_pick_reasons) {
  return bits_in(map::kNoPickReasonsBitNames, no_pick_reasons);
}

map::CommandCode command_code_of(const std::string& name) {
  std::string names;
  for (const map::NamedValue& known : map::kCommandCodeNames) {
    if (name == known.name) return static_cast<map::CommandCode>(known.value);
    names += std::string(names.empty() ? "" : ", ") + known.name;
  }
  throw app::SetupError("there is no command '" + name + "': " + names);
}

std::string address_text(int address) {
  return std::to_string(address) + " (" + std::to_string(40001 + address) + ")";
}

std::string why_not_whole(const modbus::AnswerRegisters& r) {
  if (modbus::decode_answer(r)) return "";
  const int shift = shift_of_constants(r);
  if (shift == 1000) return "the test constants are nowhere: this is no binpick station";
  if (shift != 0) {
    return "the test constants stand " + std::to_string(shift) +
           " registers off: addresses are counted differently on the way";
  }
  if (at(r, map::kAddressMapVersion) != map::kVersion ||
      at(r, map::kAddressMapChecksum) != map::kChecksum) {
    return "map version " + std::to_string(at(r, map::kAddressMapVersion)) + " checksum " +
           std::to_string(at(r, map::kAddressMapChecksum)) + ", this program knows version " +
           std::to_string(map::kVersion) + " checksum " + std::to_string(map::kChecksum);
  }
  if (at(r, map::kAddressResultSequence) != at(r, map::kAddressResultSequenceTail)) {
    return "torn: result_sequence " + std::to_string(at(r, map::kAddressResultSequence)) +
           " but result_sequence_tail " + std::to_string(at(r, map::kAddressResultSequenceTail));
  }
  return "constants, conventions or picks contradict each other";
}

void print_conventions(const modbus::DecodedAnswer& decoded) {
  const modbus::Encoding& e = decoded.encoding;
  std::printf(
      "  map version %d, checksum %d; word order %s, rotation %s, lengths in %s, angles in "
      "%s\n",
      map::kVersion, map::kChecksum,
      name_in(map::kWordOrderNames, static_cast<unsigned>(e.word_order)).c_str(),
      name_in(map::kRotationConventionNames, static_cast<unsigned>(e.rotation)).c_str(),
      e.length == map::LengthUnit::kUm ? "0.001 mm" : "0.0001 inch",
      e.angle == map::AngleUnit::kDeg1e4 ? "0.0001 deg" : "0.000001 rad");
}

void print_answer(const modbus::DecodedAnswer& decoded) {
  const modbus::AnswerSnapshot& a = decoded.answer;
  line(map::kAddressState, "state", state_text(a.state));
  line(map::kAddressStationHeartbeat, "station_heartbeat", a.station_heartbeat);
  line(map::kAddressAcknowledgedSequence, "acknowledged_sequence", a.acknowledged_sequence);
  line(map::kAddressResultSequence, "result_sequence", a.result_sequence);
  line(map::kAddressResultCommand, "result_command", a.result_command);
  line(map::kAddressCause, "cause",
       std::to_string(static_cast<int>(a.cause)) + " " + name_of(a.cause));
  line(map::kAddressNoPickReasons, "no_pick_reasons", reasons_text(a.no_pick_reasons));
  line(map::kAddressDetections, "detections", a.detections);
  line(map::kAddressPicks, "picks", a.picks);
  line(map::kAddressPage, "page", a.page);
  line(map::kAddressPagePicks, "page_picks", a.page_pick_count);
  line(map::kAddressRecipe, "recipe", a.recipe);
  line(map::kAddressCycleNumber, "cycle_number", a.cycle_number);
  const bool frame = decoded.age_ms != modbus::kAgeNone;
  line(map::kAddressAge, "age", frame ? std::to_string(decoded.age_ms) + " ms" : "no frame yet");
  line(map::kAddressCycleTime, "cycle_time", std::to_string(a.cycle_time_ms) + " ms");
  line(map::kAddressResultSequenceTail, "result_sequence_tail", a.result_sequence);
}

void print_picks(const modbus::DecodedAnswer& decoded, const modbus::AnswerRegisters& registers) {
  const modbus::AnswerSnapshot& a = decoded.answer;
  if (a.page_pick_count == 0) {
    std::printf("no picks: %s\n", reasons_text(a.no_pick_reasons).c_str());
    return;
  }
  const bool quaternion = modbus::is_quaternion(decoded.encoding.rotation);
  std::printf("%-4s %11s %11s %11s  %-36s %6s %7s %6s %s\n", "pick", "x", "y", "z",
              quaternion ? "quaternion" : "rotation 1, 2, 3", "score", "visible", "recipe",
              "flags");
  for (int i = 0; i < a.page_pick_count; ++i) {
    const modbus::Pick& pick = a.page_picks[static_cast<std::size_t>(i)];
    const int start = map::kPicksStart - map::kAnswerStart + i * map::kPickSize;
    const auto words = std::span(registers).subspan(static_cast<std::size_t>(start));
    const bool inches = decoded.encoding.length == map::LengthUnit::kInch1e4;
    const Vec3 t = pick.T_ref_part.t_mm / (inches ? 25.4 : 1.0);
    std::printf("%-4d %11.3f %11.3f %11.3f ", (a.page - 1) * map::kPicksPerPage + i + 1, t.x(),
                t.y(), t.z());
    for (std::size_t k = 0; k < (quaternion ? 4U : 3U); ++k) {
      const auto word = words.subspan(map::kPickRotation1 + (quaternion ? k : 2 * k));
      const double unit = decoded.encoding.angle == map::AngleUnit::kDeg1e4 ? 1e-4 : 1e-6;
      std::printf(" %*.4f", quaternion ? 8 : 11,
                  quaternion ? static_cast<std::int16_t>(word[0]) / 32767.0
                             : modbus::get_int32(word, decoded.encoding.word_order) * unit);
    }
    std::printf("  %6.3f %7.3f %6d %s\n", pick.score, pick.visible, pick.recipe,
                bits_in(map::kPickFlagsBitNames, pick.flags).c_str());
  }
}

}  // namespace binpick::plc
