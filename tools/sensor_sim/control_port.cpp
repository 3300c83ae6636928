#include "control_port.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace binpick::sim {
namespace {

constexpr std::size_t kLineMax = 1024;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path)
    throw std::runtime_error(path + ": too long for the path of a socket");
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

int listen_at(const std::string& path) {
  const sockaddr_un address = address_of(path);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool served = connect(probe, generic, sizeof address) == 0;
  close(probe);
  if (served) throw std::runtime_error(path + ": another program serves this socket");
  if (errno == ECONNREFUSED) unlink(path.c_str());
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listener < 0 || bind(listener, generic, sizeof address) != 0 || listen(listener, 4) != 0) {
    const std::string reason = std::strerror(errno);
    if (listener >= 0) close(listener);
    throw std::runtime_error(path + ": no socket can be made (" + reason + ")");
  }
  return listener;
}

}  // namespace

ControlPort::ControlPort(const std::string& socket_path, Handler handler)
    : path_(socket_path), handler_(std::move(handler)) {
  sources_[STDIN_FILENO].out = STDOUT_FILENO;
  if (!path_.empty()) listener_ = listen_at(path_);
}

ControlPort::~ControlPort() {
  for (const auto& [descriptor, source] : sources_) {
    if (descriptor != STDIN_FILENO) close(descriptor);
  }
  if (listener_ < 0) return;
  close(listener_);
  unlink(path_.c_str());
}

void ControlPort::add_descriptors(std::vector<pollfd>& descriptors) const {
  if (listener_ >= 0) descriptors.push_back({listener_, POLLIN, 0});
  for (const auto& [descriptor, source] : sources_) descriptors.push_back({descriptor, POLLIN, 0});
}

void ControlPort::accept_client() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client >= 0) sources_[client].out = client;
}

// False when there will be no more lines.
bool ControlPort::read_lines(int descriptor, Source& source) {
  char buffer[512];
  const ssize_t count = ::read(descriptor, buffer, sizeof buffer);
  if (count <= 0) return count < 0 && errno == EINTR;
  source.text.append(buffer, static_cast<std::size_t>(count));
  std::size_t end = 0;
  while ((end = source.text.find('\n')) != std::string::npos) {
    const std::string answer = handler_(source.text.substr(0, end)) + "\n";
    source.text.erase(0, end + 1);
    const bool is_socket = descriptor != STDIN_FILENO;
    const ssize_t sent =
        is_socket ? send(source.out, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT)
                  : ::write(source.out, answer.data(), answer.size());
    if (sent < 0 && is_socket) return false;
  }
  return source.text.size() <= kLineMax;
}

void ControlPort::serve(const std::vector<pollfd>& descriptors) {
  for (const pollfd& entry : descriptors) {
    if (entry.revents == 0) continue;
    if (entry.fd == listener_) {
      accept_client();
      continue;
    }
    const auto it = sources_.find(entry.fd);
    if (it == sources_.end() || read_lines(entry.fd, it->second)) continue;
    if (entry.fd != STDIN_FILENO) close(entry.fd);
    sources_.erase(it);
  }
}

}  // namespace binpick::sim
