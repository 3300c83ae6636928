#include "raw_client.hpp"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstring>
#include <stdexcept>

#include "clock.hpp"

namespace binpick::modbus {
namespace {

sockaddr_in loopback(const std::string& address, int port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, address.c_str(), &out.sin_addr);
  return out;
}

}  // namespace

RawClient::RawClient(int port, const std::string& source)
    : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const int on = 1;
  ::setsockopt(fd_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const sockaddr_in from = loopback(source, 0);
  const sockaddr_in to = loopback("127.0.0.1", port);
  if (::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0 ||
      ::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    throw std::runtime_error(std::string("cannot connect: ") + std::strerror(errno));
  }
}

bool RawClient::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const auto sent = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

bool RawClient::receive_bytes(std::span<std::uint8_t> bytes, int timeout_ms) {
  const std::int64_t end_ns = app::monotonic_ns() + std::int64_t{timeout_ms} * 1'000'000;
  while (!bytes.empty()) {
    const std::int64_t left_ms = (end_ns - app::monotonic_ns()) / 1'000'000;
    pollfd wait{.fd = fd_.get(), .events = POLLIN, .revents = 0};
    if (left_ms <= 0 || ::poll(&wait, 1, static_cast<int>(left_ms)) <= 0) return false;
    const auto got = ::recv(fd_.get(), bytes.data(), bytes.size(), 0);
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

std::span<const std::uint8_t> RawClient::receive(int timeout_ms) {
  const std::span all(answer_);
  if (!receive_bytes(all.first(6), timeout_ms)) return {};
  const auto length = static_cast<std::size_t>(all[4] << 8 | all[5]);
  if (length > all.size() - 6 || !receive_bytes(all.subspan(6, length), timeout_ms)) return {};
  return all.first(6 + length);
}

std::span<const std::uint8_t> RawClient::ask(std::span<const std::uint8_t> frame, int timeout_ms) {
  if (!send(frame)) return {};
  const auto answer = receive(timeout_ms);
  return answer.size() < 8 ? answer : answer.subspan(7);
}

bool RawClient::read_answer(AnswerRegisters& registers, int function) {
  const std::array<std::uint8_t, 12> request = {0, 1,
                                                0, 0,
                                                0, 6,
                                                1, static_cast<std::uint8_t>(function),
                                                0, map::kAnswerStart,
                                                0, map::kAnswerCount};
  const auto answer = ask(request);
  if (answer.size() != 2 + 2 * registers.size()) return false;
  for (std::size_t i = 0; i < registers.size(); ++i) {
    registers[i] = static_cast<std::uint16_t>(answer[2 + 2 * i] << 8 | answer[3 + 2 * i]);
  }
  return true;
}

bool RawClient::is_closed_within(int timeout_ms) {
  const std::int64_t end_ns = app::monotonic_ns() + std::int64_t{timeout_ms} * 1'000'000;
  while (true) {
    const std::int64_t left_ms = (end_ns - app::monotonic_ns()) / 1'000'000;
    pollfd wait{.fd = fd_.get(), .events = POLLIN, .revents = 0};
    if (left_ms <= 0 || ::poll(&wait, 1, static_cast<int>(left_ms)) <= 0) return false;
    if (::recv(fd_.get(), answer_.data(), answer_.size(), 0) <= 0) return true;
  }
}

}  // namespace binpick::modbus
