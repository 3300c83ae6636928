#include "modbus/listener.hpp"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cstring>

#include "modbus/address_list.hpp"
#include "setup_error.hpp"

namespace binpick::modbus {
namespace {

constexpr int kBacklog = 64;
// Answers are 260 bytes: what the kernel keeps for a client that does not read is bounded too.
constexpr int kSendBufferBytes = 16 * 1024;

[[noreturn]] void fail(const std::string& bind_address, int port) {
  throw app::SetupError("cannot serve Modbus on " + bind_address + ":" + std::to_string(port) +
                        ": " + std::strerror(errno));
}

void set(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

}  // namespace

Listener listen_on(const std::string& bind_address, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(parse_address(bind_address));
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  Listener listener{.fd = OwnedFd(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)),
                    .port = port};
  if (!listener.fd) fail(bind_address, port);
  const int fd = listener.fd.get();
  set(fd, SOL_SOCKET, SO_REUSEADDR, 1);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t length = sizeof address;
  if (::bind(fd, generic, length) != 0 || ::listen(fd, kBacklog) != 0 ||
      ::getsockname(fd, generic, &length) != 0) {
    fail(bind_address, port);
  }
  listener.port = ntohs(address.sin_port);
  return listener;
}

void tune_client_socket(int fd) {
  set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set(fd, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);
  set(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(fd, IPPROTO_TCP, TCP_KEEPIDLE, 4);
  set(fd, IPPROTO_TCP, TCP_KEEPINTVL, 2);
  set(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, 10'000);
}

}  // namespace binpick::modbus
