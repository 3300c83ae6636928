// What a result is in the answer block, and an order in the command block: one place for the
// Modbus server, the recorder and the replay. Pure; allocates nothing.
#pragma once

#include "modbus/answer.hpp"
#include "modbus/command.hpp"
#include "station/cycle_result.hpp"

namespace binpick::app {

// All but state, heartbeat, acknowledged and result sequence, which are the server's.
void fill_answer(const CycleResult& result, modbus::AnswerSnapshot& answer);

// The command registers that give this order: of the PLC as they were written, of others as a PLC
// would write them, with a heartbeat of 0.
modbus::CommandRegisters command_registers(const Order& order, const modbus::Encoding& encoding);

// The other way; judged by what the registers themselves show.
Order order_of_command(const modbus::CommandRegisters& registers, const modbus::Encoding& encoding,
                       bool flange_needed, std::int64_t received_ns);

}  // namespace binpick::app
