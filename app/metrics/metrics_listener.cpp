#include "metrics/metrics_listener.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "setup_error.hpp"

namespace binpick::app {
namespace {

constexpr int kBacklog = 16;

[[noreturn]] void refuse(const std::string& listen, const std::string& reason) {
  throw SetupError("metrics: " + listen + ": " + reason);
}

union Address {
  sockaddr any;
  sockaddr_un unix_path;
  sockaddr_in ip4;
  sockaddr_in6 ip6;
  Address() { std::memset(this, 0, sizeof *this); }
};

socklen_t loopback_address(const std::string& listen, Address& address) {
  const std::size_t colon = listen.rfind(':');
  if (colon == std::string::npos)
    refuse(listen, "is neither the path of a socket (/...) nor ADDRESS:PORT");
  std::string host = listen.substr(0, colon);
  unsigned port = 65536;
  const char* end = listen.data() + listen.size();
  const auto parsed = std::from_chars(listen.data() + colon + 1, end, port);
  if (parsed.ec != std::errc{} || parsed.ptr != end || port > 65535)
    refuse(listen, "the port is not a number from 0 to 65535");
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  const auto network_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.ip4.sin_addr) == 1 &&
      ntohl(address.ip4.sin_addr.s_addr) >> 24 == 127) {
    address.ip4.sin_family = AF_INET;
    address.ip4.sin_port = network_port;
    return sizeof address.ip4;
  }
  if (inet_pton(AF_INET6, host.c_str(), &address.ip6.sin6_addr) == 1 &&
      IN6_IS_ADDR_LOOPBACK(&address.ip6.sin6_addr)) {
    address.ip6.sin6_family = AF_INET6;
    address.ip6.sin6_port = network_port;
    return sizeof address.ip6;
  }
  refuse(listen, "is no address of the loopback interface: metrics are for this machine");
}

socklen_t socket_address(const std::string& listen, Address& address) {
  if (listen.size() >= sizeof address.unix_path.sun_path) refuse(listen, "the path is too long");
  address.unix_path.sun_family = AF_UNIX;
  std::memcpy(address.unix_path.sun_path, listen.data(), listen.size());
  // What an earlier process left; anything but a socket stays and is an error below.
  struct stat status {};
  if (lstat(listen.c_str(), &status) == 0 && S_ISSOCK(status.st_mode)) unlink(listen.c_str());
  return sizeof address.unix_path;
}

}  // namespace

MetricsListener open_metrics_listener(const std::string& listen) {
  Address address;
  const bool is_path = listen.starts_with('/');
  socklen_t length = is_path ? socket_address(listen, address) : loopback_address(listen, address);
  MetricsListener listener;
  listener.fd = socket(address.any.sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  const bool good =
      listener.fd >= 0 &&
      (is_path || setsockopt(listener.fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0) &&
      bind(listener.fd, &address.any, length) == 0 && ::listen(listener.fd, kBacklog) == 0;
  if (!good) {
    const std::string reason = std::strerror(errno);
    if (listener.fd >= 0) close(listener.fd);
    refuse(listen, "cannot be listened at: " + reason);
  }
  if (is_path) {
    listener.socket_path = listen;
    chmod(listen.c_str(), 0660);
    return listener;
  }
  getsockname(listener.fd, &address.any, &length);
  listener.port =
      ntohs(address.any.sa_family == AF_INET ? address.ip4.sin_port : address.ip6.sin6_port);
  return listener;
}

}  // namespace binpick::app
