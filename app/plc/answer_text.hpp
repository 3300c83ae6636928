// What people read of an answer.
#pragma once

#include <string>

#include "modbus/answer.hpp"
#include "modbus/command.hpp"

namespace binpick::plc {

std::string name_of(modbus::map::Cause cause);
std::string name_of(modbus::map::CommandCode code);
std::string state_text(std::uint16_t state);              // names of the bits, comma-separated
std::string reasons_text(std::uint16_t no_pick_reasons);  // the same

// Throws app::SetupError with the names there are.
modbus::map::CommandCode command_code_of(const std::string& name);

// "111 (40112)": the address as on the wire and counted from 1.
std::string address_text(int address);

// Why the registers are not one whole answer of this map: wrong map, word order that nobody set,
// registers one off, a torn read. Empty when they are.
std::string why_not_whole(const modbus::AnswerRegisters& registers);

void print_conventions(const modbus::DecodedAnswer& decoded);
void print_answer(const modbus::DecodedAnswer& decoded);
// One row a pick: position and rotation as the registers say them, score, visible share, flags.
void print_picks(const modbus::DecodedAnswer& decoded, const modbus::AnswerRegisters& registers);

}  // namespace binpick::plc
