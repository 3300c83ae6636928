#include "daemon/control_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "clock.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path)
    throw SetupError("station.control_socket: " + path + " is too long for a socket");
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

// A daemon that was killed leaves its socket behind; one that lives answers.
bool somebody_listens(const sockaddr_un& address) {
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const bool connected =
      connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  return connected;
}

bool is_socket(const std::string& path) {
  struct stat info {};
  return lstat(path.c_str(), &info) == 0 && S_ISSOCK(info.st_mode);
}

}  // namespace

ControlSocket::ControlSocket(const std::string& path, Handlers handlers)
    : path_(path), handlers_(std::move(handlers)) {
  if (path_.empty()) return;
  const sockaddr_un address = address_of(path_);
  if (somebody_listens(address))
    throw SetupError("station.control_socket: " + path_ + ": another daemon listens there");
  if (is_socket(path_)) unlink(path_.c_str());
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t before = umask(0007);  // owner and group
  const bool bound =
      listener_ >= 0 &&
      bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      listen(listener_, kClientsMax) == 0;
  const int error = errno;
  umask(before);
  if (bound) return;
  if (listener_ >= 0) close(listener_);
  throw SetupError("station.control_socket: " + path_ + ": " + std::strerror(error));
}

ControlSocket::~ControlSocket() {
  for (Client& client : clients_) drop(client);
  if (listener_ < 0) return;
  close(listener_);
  unlink(path_.c_str());
}

std::size_t ControlSocket::put_descriptors(std::span<pollfd, kDescriptorsMax> descriptors) const {
  std::size_t count = 0;
  if (listener_ >= 0) descriptors[count++] = {listener_, POLLIN, 0};
  for (const Client& client : clients_) {
    if (client.descriptor >= 0) descriptors[count++] = {client.descriptor, POLLIN, 0};
  }
  return count;
}

void ControlSocket::handle(std::span<const pollfd> descriptors) {
  for (const pollfd& d : descriptors) {
    if (d.revents == 0) continue;
    if (d.fd == listener_) {
      accept_client();
      continue;
    }
    for (Client& client : clients_) {
      if (client.descriptor == d.fd) read_from(client);
    }
  }
}

void ControlSocket::accept_client() {
  const int descriptor = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) return;
  for (Client& client : clients_) {
    if (client.descriptor >= 0) continue;
    client = {descriptor, {}, 0};
    return;
  }
  Client refused{descriptor, {}, 0};
  send(refused, fault_json("too many clients"));
  drop(refused);
}

void ControlSocket::read_from(Client& client) {
  char bytes[kLineMax];
  const ssize_t count = recv(client.descriptor, bytes, sizeof bytes, 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) return drop(client);
  client.input.append(bytes, static_cast<std::size_t>(count));
  if (client.input.find('\n') == std::string::npos && client.input.size() > kLineMax)
    return drop(client);
  serve_lines(client);
}

// Lines behind an order wait until it is answered.
void ControlSocket::serve_lines(Client& client) {
  while (client.descriptor >= 0 && client.waits_for == 0) {
    const std::size_t end = client.input.find('\n');
    if (end == std::string::npos) break;
    const std::string line = client.input.substr(0, end);
    client.input.erase(0, end + 1);
    if (std::string reply = reply_to(client, line); !reply.empty()) send(client, std::move(reply));
  }
  if (client.input.size() > 8 * kLineMax) drop(client);
}

// Empty: the answer comes later.
std::string ControlSocket::reply_to(Client& client, std::string_view line) {
  ControlRequest request = parse_control_line(line);
  switch (request.kind) {
    case ControlRequest::Kind::kStatus:
      return handlers_.status();
    case ControlRequest::Kind::kRecord:
      return handlers_.record() ? R"({"ok":true})" : fault_json("recorder.folder is not set");
    case ControlRequest::Kind::kHelp:
      return kControlHelp;
    case ControlRequest::Kind::kWrong:
      return fault_json(request.fault);
    case ControlRequest::Kind::kOrder:
      break;
  }
  request.order.source = OrderSource::kControl;
  request.order.sequence = ++sequence_ == 0 ? ++sequence_ : sequence_;
  request.order.received_ns = monotonic_ns();
  const auto waits = [](const Client& c) { return c.descriptor >= 0 && c.waits_for != 0; };
  // One at a time: each order is sure to find its answer on the board.
  if (std::any_of(clients_.begin(), clients_.end(), waits) || !handlers_.offer(request.order))
    return refusal_json(Cause::kBusy, "busy: another order is under way");
  client.waits_for = request.order.sequence;
  return "";
}

void ControlSocket::answer(const CycleResult& result) {
  for (Client& client : clients_) {
    if (client.descriptor < 0 || client.waits_for != result.order.sequence) continue;
    client.waits_for = 0;
    send(client, result_json(result));
    serve_lines(client);
  }
}

void ControlSocket::send(Client& client, std::string line) {
  line += '\n';
  const ssize_t sent =
      ::send(client.descriptor, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(line.size())) drop(client);  // it does not read: not our loss
}

void ControlSocket::drop(Client& client) {
  if (client.descriptor >= 0) close(client.descriptor);
  client = {};
}

}  // namespace binpick::app
