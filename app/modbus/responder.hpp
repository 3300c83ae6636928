// Answers one judged request: libmodbus' modbus_reply over a pair of sockets of our own, so that it
// never waits for a client; what it sends is picked up again and handed back. Holds the registers
// that requests read and write. No allocation after construction. Thread: the server's.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "modbus/answer_image.hpp"
#include "modbus/mbap.hpp"
#include "modbus/owned_fd.hpp"
#include "modbus/request.hpp"

namespace binpick::modbus {

class Responder {
 public:
  // Throws app::SetupError when the system gives no sockets.
  // Shows an answer without a result until the first is published.
  Responder(std::uint8_t unit_id, const Encoding& encoding);
  ~Responder();
  Responder(const Responder&) = delete;
  Responder& operator=(const Responder&) = delete;

  // What requests from now on see. Nothing is copied when the revision is the one it has.
  void show(const PublishedAnswer& answer, std::int64_t now_ns);

  struct Reply {
    std::span<const std::uint8_t> bytes;  // valid until the next call
    Exception exception = Exception::kNone;
    bool wrote = false;
  };
  Reply reply(std::span<const std::uint8_t> frame, bool may_write);

  std::span<const std::uint16_t> command_registers() const {
    return std::span(registers_).subspan(map::kCommandStart, map::kCommandCount);
  }

 private:
  struct Modbus;  // keeps <modbus.h> out of here

  std::span<const std::uint8_t> serve(std::span<const std::uint8_t> frame);

  std::uint8_t unit_id_;
  map::WordOrder order_;
  std::uint64_t revision_ = 0;
  std::array<std::uint16_t, map::kEnd> registers_{};
  std::array<std::uint8_t, kFrameBytesMax> response_{};
  OwnedFd ours_;
  OwnedFd library_;
  std::unique_ptr<Modbus> modbus_;
};

}  // namespace binpick::modbus
