#include "modbus/responder.hpp"

#include <modbus.h>
#include <sys/socket.h>

#include <algorithm>

#include "binpick/base/assert.hpp"
#include "setup_error.hpp"

namespace binpick::modbus {

struct Responder::Modbus {
  modbus_t* context = nullptr;
  modbus_mapping_t mapping{};

  Modbus() : context(modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT)) {
    if (context == nullptr) throw app::SetupError("libmodbus gives no context");
  }
  ~Modbus() { modbus_free(context); }
  Modbus(const Modbus&) = delete;
  Modbus& operator=(const Modbus&) = delete;
};

Responder::Responder(std::uint8_t unit_id, const Encoding& encoding)
    : unit_id_(unit_id), order_(encoding.word_order), modbus_(std::make_unique<Modbus>()) {
  AnswerRegisters nothing;
  encode_answer({}, encoding, nothing);
  std::copy(nothing.begin(), nothing.end(), registers_.begin() + map::kAnswerStart);
  // SEQPACKET keeps one reply one packet.
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) != 0) {
    throw app::SetupError("no pair of sockets for libmodbus");
  }
  ours_.reset(pair[0]);
  library_.reset(pair[1]);
  modbus_set_socket(modbus_->context, library_.get());
  modbus_mapping_t& mapping = modbus_->mapping;
  mapping.nb_registers = mapping.nb_input_registers = map::kEnd;
  mapping.tab_registers = mapping.tab_input_registers = registers_.data();
}

Responder::~Responder() = default;

void Responder::show(const PublishedAnswer& answer, std::int64_t now_ns) {
  const auto block = std::span(registers_).subspan(map::kAnswerStart, map::kAnswerCount);
  if (answer.revision != revision_) {
    std::copy(answer.registers.begin(), answer.registers.end(), block.begin());
    revision_ = answer.revision;
  }
  if (answer.capture_ns == 0) return;
  const std::int64_t age_ms = (now_ns - answer.capture_ns) / 1'000'000;
  put_age(block, order_,
          static_cast<std::uint32_t>(std::clamp<std::int64_t>(age_ms, 0, kAgeNone - 1)));
}

Responder::Reply Responder::reply(std::span<const std::uint8_t> frame, bool may_write) {
  const RequestVerdict verdict = judge_request(frame, unit_id_, may_write);
  Exception exception = verdict.exception;
  if (exception == Exception::kNone) {
    const auto bytes = serve(frame);
    if (!bytes.empty()) return {bytes, Exception::kNone, verdict.writes};
    exception = Exception::kServerFailure;
  }
  const ExceptionFrame refusal = exception_frame(frame, exception);
  std::copy(refusal.begin(), refusal.end(), response_.begin());
  // A write whose answer was lost has been done all the same.
  return {std::span(response_).first(refusal.size()), exception, verdict.writes};
}

std::span<const std::uint8_t> Responder::serve(std::span<const std::uint8_t> frame) {
  if (modbus_reply(modbus_->context, frame.data(), static_cast<int>(frame.size()),
                   &modbus_->mapping) <= 0) {
    return {};
  }
  const auto got = ::recv(ours_.get(), response_.data(), response_.size(), 0);
  return got > 0 ? std::span(response_).first(static_cast<std::size_t>(got))
                 : std::span<const std::uint8_t>{};
}

}  // namespace binpick::modbus
