// The daemon's log: a line a message on the error output, with the level in front as the journal
// reads it (sd-daemon(3)). No allocation; a message is cut at 500 bytes. Thread-safe: one write(2)
// a line.
#pragma once

#include <atomic>
#include <cstdarg>

#include "config/config.hpp"

namespace binpick::app {

class Log {
 public:
  explicit Log(LogLevel level);
  void set_level(LogLevel level) { level_.store(level, std::memory_order_relaxed); }
  void error(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void warning(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void info(const char* format, ...) __attribute__((format(printf, 2, 3)));
  void debug(const char* format, ...) __attribute__((format(printf, 2, 3)));

 private:
  void write(LogLevel level, const char* format, va_list arguments);

  std::atomic<LogLevel> level_;
  const bool for_journal_;
};

}  // namespace binpick::app
