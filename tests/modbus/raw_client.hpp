// A client on a plain socket: sends any bytes, at any pace, from any loopback address. After
// connecting it allocates nothing, so that it may run where allocations are counted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "modbus/answer.hpp"
#include "modbus/owned_fd.hpp"

namespace binpick::modbus {

class RawClient {
 public:
  // From `source`, such as "127.0.0.2". Throws std::runtime_error when the connection is refused
  // by the system; a server that closes at once is seen by the first receive.
  explicit RawClient(int port, const std::string& source = "127.0.0.1");

  bool send(std::span<const std::uint8_t> bytes);  // false: the connection is gone
  // The bytes of one answer; empty when none came in time or the server closed.
  std::span<const std::uint8_t> receive(int timeout_ms = 5000);
  // Request and answer, without their headers.
  std::span<const std::uint8_t> ask(std::span<const std::uint8_t> frame, int timeout_ms = 5000);
  // The whole answer block by function 3 or 4.
  bool read_answer(AnswerRegisters& registers, int function = 3);
  // Whether the server closes the connection within this time.
  bool is_closed_within(int timeout_ms);
  int fd() const { return fd_.get(); }

 private:
  bool receive_bytes(std::span<std::uint8_t> bytes, int timeout_ms);

  OwnedFd fd_;
  std::array<std::uint8_t, 512> answer_{};
};

}  // namespace binpick::modbus
