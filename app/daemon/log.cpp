#include "daemon/log.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace binpick::app {
namespace {

constexpr const char* kNames[] = {"error: ", "warning: ", "", "debug: "};
constexpr int kPriorities[] = {3, 4, 6, 7};  // syslog's

void write_line(LogLevel level, bool for_journal, const char* format, va_list arguments) {
  char line[512];
  const auto index = static_cast<std::size_t>(level);
  int length = for_journal ? std::snprintf(line, sizeof line, "<%d>", kPriorities[index])
                           : std::snprintf(line, sizeof line, "binpickd: %s", kNames[index]);
  const auto room = sizeof line - static_cast<std::size_t>(length) - 1;
  const int text = std::vsnprintf(line + length, room, format, arguments);
  length += std::clamp(text, 0, static_cast<int>(room) - 1);
  std::replace(line, line + length, '\n', ' ');
  line[length++] = '\n';
  // A log that nobody takes is no reason to do anything else.
  [[maybe_unused]] const ssize_t written =
      ::write(STDERR_FILENO, line, static_cast<std::size_t>(length));
}

}  // namespace

Log::Log(LogLevel level) : level_(level), for_journal_(std::getenv("JOURNAL_STREAM") != nullptr) {}

void Log::write(LogLevel level, const char* format, va_list arguments) {
  if (level <= level_.load(std::memory_order_relaxed))
    write_line(level, for_journal_, format, arguments);
}

void Log::error(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write(LogLevel::kError, format, arguments);
  va_end(arguments);
}

void Log::warning(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write(LogLevel::kWarning, format, arguments);
  va_end(arguments);
}

void Log::info(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write(LogLevel::kInfo, format, arguments);
  va_end(arguments);
}

void Log::debug(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write(LogLevel::kDebug, format, arguments);
  va_end(arguments);
}

}  // namespace binpick::app
