#include "plc/plc_client.hpp"

#include <errno.h>
#include <modbus.h>

#include "setup_error.hpp"

namespace binpick::plc {

struct PlcClient::Context {
  modbus_t* modbus = nullptr;
  explicit Context(modbus_t* made) : modbus(made) {}
  ~Context() {
    if (modbus == nullptr) return;
    modbus_close(modbus);
    modbus_free(modbus);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

PlcClient::PlcClient(const Target& target)
    : target_(target),
      context_(std::make_unique<Context>(
          modbus_new_tcp_pi(target.host.c_str(), std::to_string(target.port).c_str()))) {
  modbus_t* modbus = context_->modbus;
  if (modbus == nullptr) fail("cannot be addressed");
  const auto seconds = static_cast<std::uint32_t>(target.timeout_ms / 1000);
  const auto microseconds = static_cast<std::uint32_t>(target.timeout_ms % 1000 * 1000);
  modbus_set_response_timeout(modbus, seconds, microseconds);
  modbus_set_slave(modbus, target.unit_id);
  if (modbus_connect(modbus) != 0) fail("does not accept the connection");
}

PlcClient::~PlcClient() = default;

void PlcClient::fail(const char* what) const {
  const int error = errno;
  throw app::SetupError(target_.host + ":" + std::to_string(target_.port) + " " + what + ": " +
                        modbus_strerror(error));
}

void PlcClient::read_answer(modbus::AnswerRegisters& registers) {
  namespace map = modbus::map;
  by_input_ = !by_input_;
  const int got = by_input_ ? modbus_read_input_registers(context_->modbus, map::kAnswerStart,
                                                          map::kAnswerCount, registers.data())
                            : modbus_read_registers(context_->modbus, map::kAnswerStart,
                                                    map::kAnswerCount, registers.data());
  if (got != map::kAnswerCount) fail("does not give its answer block");
}

void PlcClient::write_command(const modbus::CommandRegisters& registers) {
  namespace map = modbus::map;
  if (modbus_write_registers(context_->modbus, map::kCommandStart, map::kCommandCount,
                             registers.data()) != map::kCommandCount) {
    fail("does not take a command (may this address write?)");
  }
}

void PlcClient::write_heartbeat(std::uint16_t value) {
  if (modbus_write_register(context_->modbus, modbus::map::kAddressPlcHeartbeat, value) != 1) {
    fail("does not take a heartbeat (may this address write?)");
  }
}

}  // namespace binpick::plc
