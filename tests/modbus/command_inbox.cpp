#include "command_inbox.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include "setup_error.hpp"

namespace binpick::modbus {

CommandInbox::CommandInbox() : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!event_) throw app::SetupError("no event descriptor for commands");
}

void CommandInbox::put(const TakenCommand& command) {
  const std::lock_guard lock(mutex_);
  if (full_) ++replaced_;
  command_ = command;
  full_ = true;
  const std::uint64_t one = 1;
  // Cannot fail but by a counter of 2^64 - 1: it is readable then, as wanted.
  [[maybe_unused]] const auto written = ::write(event_.get(), &one, sizeof one);
}

bool CommandInbox::take(TakenCommand& command) {
  const std::lock_guard lock(mutex_);
  std::uint64_t events = 0;
  [[maybe_unused]] const auto read = ::read(event_.get(), &events, sizeof events);
  if (!full_) return false;
  command = command_;
  full_ = false;
  return true;
}

bool CommandInbox::wait(TakenCommand& command, int timeout_ms) {
  pollfd event{.fd = event_.get(), .events = POLLIN, .revents = 0};
  ::poll(&event, 1, timeout_ms);
  return take(command);
}

std::uint64_t CommandInbox::replaced_count() const {
  const std::lock_guard lock(mutex_);
  return replaced_;
}

}  // namespace binpick::modbus
