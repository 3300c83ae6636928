// The command on its way from the server's thread to a test's. One place: a newer command replaces
// one that nobody took yet, which is counted. Thread-safe; the mutex is held for a copy of forty
// bytes. No allocation.
#pragma once

#include <cstdint>
#include <mutex>

#include "modbus/command_sink.hpp"
#include "modbus/owned_fd.hpp"

namespace binpick::modbus {

class CommandInbox final : public CommandSink {
 public:
  CommandInbox();

  void put(const TakenCommand& command) override;
  // False when there is none.
  bool take(TakenCommand& command);
  // Waits; false when none came in time.
  bool wait(TakenCommand& command, int timeout_ms);
  std::uint64_t replaced_count() const;

 private:
  mutable std::mutex mutex_;
  TakenCommand command_;
  bool full_ = false;
  std::uint64_t replaced_ = 0;
  OwnedFd event_;
};

}  // namespace binpick::modbus
