// The daemon's log: lines of fixed size from any thread, written by a thread of its own to the
// journal with fields, or to the error output where there is no journal. Saying something neither
// waits nor takes from the heap: what comes too often or finds no room is left out and counted.
// Thread-safe.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdarg>
#include <string>
#include <thread>

#include "log/journal_socket.hpp"
#include "log/log_ring.hpp"
#include "log/rate_limit.hpp"

namespace binpick::app {

struct LogParams {
  LogLevel level = LogLevel::kInfo;
  const char* identifier = "binpickd";
  std::string journal_path = JournalSocket::path_of_journal();  // empty: the error output
  int fallback_fd = 2;
  RateLimitParams rate;
};

struct LogCounters {
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;     // no room: the journal is slow
  std::uint64_t suppressed = 0;  // said too often
};

class Log {
 public:
  // What the constructor takes from the heap.
  static std::size_t footprint() { return LogRing::footprint(); }
  explicit Log(const LogParams& params);
  // Writes what waits.
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void set_level(LogLevel level) { level_.store(level, std::memory_order_relaxed); }
  bool says(LogLevel level) const { return level <= level_.load(std::memory_order_relaxed); }
  // The format is the message's kind, by which it is limited: a literal.
  void error(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void warning(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void info(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void debug(const char* format, ...) __attribute__((format(printf, 2, 3)));
  // About a cycle; `cause` is a literal.
  void about_cycle(LogLevel level, std::uint64_t cycle, const char* cause, const char* format, ...)
      __attribute__((format(printf, 5, 6)));

  LogCounters counters() const;

 private:
  void put(const LogLine& head, const char* format, va_list arguments);
  void work();
  void write(const LogLine& line);

  const LogParams params_;
  std::atomic<LogLevel> level_;
  RateLimit rate_;
  LogRing ring_;
  JournalSocket journal_;
  std::uint64_t dropped_told_ = 0;  // the writer's own
  std::atomic<std::uint64_t> written_{0};
  std::atomic<bool> stopping_{false};
  sem_t wake_;          // posting never waits
  std::thread thread_;  // last: everything it uses is made before it
};

}  // namespace binpick::app
