#include "log/log.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "clock.hpp"
#include "fixed_text.hpp"

namespace binpick::app {
namespace {

constexpr const char* kNames[] = {"error: ", "warning: ", "", "debug: "};
constexpr int kPriorities[] = {3, 4, 6, 7};  // syslog's
constexpr std::size_t kMessageBytes = LogLine::kTextBytes + 256;

void add_fields(const LogLine& line, const char* identifier, FixedText& text) {
  text.print("PRIORITY=%d\nSYSLOG_IDENTIFIER=%s\n", kPriorities[static_cast<int>(line.level)],
             identifier);
  if (line.cycle > 0) text.print("BINPICK_CYCLE=%" PRIu64 "\n", line.cycle);
  if (line.cause != nullptr) text.print("BINPICK_CAUSE=%s\n", line.cause);
  if (line.suppressed > 0) text.print("BINPICK_SUPPRESSED=%" PRIu64 "\n", line.suppressed);
}

}  // namespace

Log::Log(const LogParams& params)
    : params_(params), level_(params.level), rate_(params.rate), journal_(params.journal_path) {
  sem_init(&wake_, 0, 0);
  thread_ = std::thread([this] { work(); });
}

Log::~Log() {
  stopping_ = true;
  sem_post(&wake_);
  thread_.join();
  sem_destroy(&wake_);
}

#define BINPICK_LOG_AT(name, at)            \
  void Log::name(const char* format, ...) { \
    if (!says(at)) return;                  \
    va_list arguments;                      \
    va_start(arguments, format);            \
    put({.level = at}, format, arguments);  \
    va_end(arguments);                      \
  }
BINPICK_LOG_AT(error, LogLevel::kError)
BINPICK_LOG_AT(warning, LogLevel::kWarning)
BINPICK_LOG_AT(info, LogLevel::kInfo)
BINPICK_LOG_AT(debug, LogLevel::kDebug)
#undef BINPICK_LOG_AT

void Log::about_cycle(LogLevel level, std::uint64_t cycle, const char* cause, const char* format,
                      ...) {
  if (!says(level)) return;
  va_list arguments;
  va_start(arguments, format);
  put({.level = level, .cycle = cycle, .cause = cause}, format, arguments);
  va_end(arguments);
}

void Log::put(const LogLine& head, const char* format, va_list arguments) {
  std::uint64_t suppressed = 0;
  if (!rate_.passes(format, monotonic_ns(), suppressed)) return;
  const bool put = ring_.put([&](LogLine& line) {
    line.level = head.level;
    line.cycle = head.cycle;
    line.cause = head.cause;
    line.suppressed = suppressed;
    std::vsnprintf(line.text, sizeof line.text, format, arguments);
  });
  if (put) sem_post(&wake_);
}

LogCounters Log::counters() const {
  return {written_.load(std::memory_order_relaxed), ring_.dropped_count(),
          rate_.suppressed_count()};
}

void Log::work() {
  pthread_setname_np(pthread_self(), "log");
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  for (;;) {
    while (sem_wait(&wake_) != 0) {
    }
    while (ring_.take([this](const LogLine& line) { write(line); })) {
    }
    if (const std::uint64_t dropped = ring_.dropped_count(); dropped != dropped_told_) {
      LogLine line{.level = LogLevel::kWarning};
      std::snprintf(line.text, sizeof line.text, "the log was too slow: %" PRIu64 " lines are lost",
                    dropped - dropped_told_);
      dropped_told_ = dropped;
      write(line);
    }
    if (stopping_) return;
  }
}

void Log::write(const LogLine& line) {
  char bytes[kMessageBytes];
  FixedText text(bytes);
  add_fields(line, params_.identifier, text);
  text.add("MESSAGE=");
  const std::size_t message = text.length();
  text.print("%s", line.text);
  if (line.suppressed > 0) text.print(" (and %" PRIu64 " like it were left out)", line.suppressed);
  // A line end would end the field, or the line.
  std::replace(bytes + message, bytes + text.length(), '\n', ' ');
  text.add("\n");
  written_.fetch_add(1, std::memory_order_relaxed);
  if (journal_.send(text.text())) return;
  char plain[kMessageBytes];
  FixedText out(plain);
  out.print("%s: %s", params_.identifier, kNames[static_cast<int>(line.level)]);
  out.add(text.text().substr(message));
  // A log that nobody takes is no reason to do anything else.
  [[maybe_unused]] const ssize_t done = ::write(params_.fallback_fd, plain, out.length());
}

}  // namespace binpick::app
