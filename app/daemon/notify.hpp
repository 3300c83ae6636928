// What the service manager is told: one datagram a message to the socket that NOTIFY_SOCKET names,
// as sd_notify(3) describes. Without that variable nothing is said. Thread: main.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace binpick::app {

class Notifier {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  Notifier();
  ~Notifier();
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  void ready(const char* status);
  void stopping();
  void reloading();
  void watchdog();
  void status(const char* text);
  // Within which the manager wants to hear watchdog(); none: it does not watch.
  std::optional<std::chrono::microseconds> watchdog_period() const { return watchdog_period_; }

 private:
  void send(const char* format, ...) __attribute__((format(printf, 2, 3)));

  int socket_ = -1;
  std::string address_;
  std::optional<std::chrono::microseconds> watchdog_period_;
};

}  // namespace binpick::app
