#include "daemon/notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace binpick::app {

Notifier::Notifier() {
  if (const char* path = std::getenv("NOTIFY_SOCKET")) address_ = path;
  const bool usable = (address_.starts_with('/') || address_.starts_with('@')) &&
                      address_.size() < sizeof(sockaddr_un::sun_path);
  if (usable) socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const char* period_us = std::getenv("WATCHDOG_USEC");
  const char* pid = std::getenv("WATCHDOG_PID");
  if (period_us == nullptr || (pid != nullptr && std::atoll(pid) != getpid())) return;
  if (const long long us = std::atoll(period_us); us > 0) watchdog_period_.emplace(us);
}

Notifier::~Notifier() {
  if (socket_ >= 0) close(socket_);
}

void Notifier::send(const char* format, ...) {
  if (socket_ < 0) return;
  char message[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, address_.data(), address_.size());
  if (address_[0] == '@') address.sun_path[0] = '\0';  // the abstract name space
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  // Never waits: a manager that does not read must not stop the station.
  sendto(socket_, message, std::strlen(message), MSG_NOSIGNAL | MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&address), length);
}

void Notifier::ready(const char* status) {
  send("READY=1\nSTATUS=%s", status);
}
void Notifier::stopping() {
  send("STOPPING=1");
}
void Notifier::reloading() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  send("RELOADING=1\nMONOTONIC_USEC=%lld", now.tv_sec * 1000000LL + now.tv_nsec / 1000);
}
void Notifier::watchdog() {
  send("WATCHDOG=1");
}
void Notifier::status(const char* text) {
  send("STATUS=%s", text);
}

}  // namespace binpick::app
