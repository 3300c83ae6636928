// The PLC's end of the connection, with libmodbus as client: what binpick plc is built on.
// Thread: one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "modbus/answer.hpp"
#include "modbus/command.hpp"

namespace binpick::plc {

struct Target {
  std::string host;
  int port = 502;
  int unit_id = 1;
  int timeout_ms = 1000;  // for connecting and for each answer
};

class PlcClient {
 public:
  // Throws app::SetupError naming host, port and reason.
  explicit PlcClient(const Target& target);
  ~PlcClient();
  PlcClient(const PlcClient&) = delete;
  PlcClient& operator=(const PlcClient&) = delete;

  // Each throws app::SetupError with the exception or the error that came instead of an answer.
  void read_answer(modbus::AnswerRegisters& registers);           // by function 3 and 4 in turn
  void write_command(const modbus::CommandRegisters& registers);  // one write by function 16
  void write_heartbeat(std::uint16_t value);                      // function 6

 private:
  struct Context;
  [[noreturn]] void fail(const char* what) const;

  Target target_;
  bool by_input_ = false;
  std::unique_ptr<Context> context_;
};

}  // namespace binpick::plc
