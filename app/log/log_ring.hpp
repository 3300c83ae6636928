// Lines on their way from any thread to the one that writes them: a bounded queue that nobody waits
// at. Full: the line is lost and counted. Lock-free (one ticket a cell, after D. Vyukov), nothing
// from the heap after construction.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "log/log_level.hpp"

namespace binpick::app {

struct LogLine {
  static constexpr int kTextBytes = 400;

  LogLevel level = LogLevel::kInfo;
  std::uint64_t cycle = 0;       // 0: about none
  const char* cause = nullptr;   // a literal; null: none
  std::uint64_t suppressed = 0;  // lines like this that were left out before
  char text[kTextBytes] = "";
};

class LogRing {
 public:
  static constexpr std::uint64_t kLines = 256;  // a power of two
  static std::size_t footprint();

  LogRing();
  // Calls fill(line) on a free line. False, and counted: there is none. Any thread.
  template <class Fill>
  bool put(const Fill& fill);
  // Thread: the writer's. Calls use(line) for the oldest. False: there is none.
  template <class Use>
  bool take(const Use& use);
  std::uint64_t dropped_count() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  struct Cell {
    // Whose turn it is: n: put's n-th, n + 1: take's n-th.
    std::atomic<std::uint64_t> turn{0};
    LogLine line;
  };
  Cell& cell(std::uint64_t n) { return cells_[n & (kLines - 1)]; }

  std::unique_ptr<Cell[]> cells_;
  std::atomic<std::uint64_t> put_{0};
  std::uint64_t taken_ = 0;  // the writer's own
  std::atomic<std::uint64_t> dropped_{0};
};

inline std::size_t LogRing::footprint() {
  return kLines * sizeof(Cell);
}

inline LogRing::LogRing() : cells_(std::make_unique<Cell[]>(kLines)) {
  for (std::uint64_t i = 0; i < kLines; ++i) cells_[i].turn = i;
}

template <class Fill>
bool LogRing::put(const Fill& fill) {
  std::uint64_t n = put_.load(std::memory_order_relaxed);
  for (;;) {
    const std::uint64_t turn = cell(n).turn.load(std::memory_order_acquire);
    if (turn == n) {
      if (put_.compare_exchange_weak(n, n + 1, std::memory_order_relaxed)) break;
    } else if (turn < n) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    } else {
      n = put_.load(std::memory_order_relaxed);
    }
  }
  fill(cell(n).line);
  cell(n).turn.store(n + 1, std::memory_order_release);
  return true;
}

template <class Use>
bool LogRing::take(const Use& use) {
  Cell& oldest = cell(taken_);
  if (oldest.turn.load(std::memory_order_acquire) != taken_ + 1) return false;
  use(oldest.line);
  oldest.turn.store(taken_ + kLines, std::memory_order_release);
  ++taken_;
  return true;
}

}  // namespace binpick::app
