// The published answer, between the thread that makes it and the server's thread. Three slots and
// one atomic: neither side ever waits, and a reader gets the newest answer whole or the one before
// it whole. No allocation. Thread: publish() by one thread at a time, latest() by one thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "modbus/answer.hpp"

namespace binpick::modbus {

struct PublishedAnswer {
  AnswerRegisters registers{};
  std::int64_t capture_ns = 0;  // monotonic clock; 0: no frame yet
  std::uint64_t revision = 0;   // counts publications; 0: none yet
};

class AnswerImage {
 public:
  void publish(const AnswerRegisters& registers, std::int64_t capture_ns) {
    slots_[back_] = {registers, capture_ns, ++revision_};
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  // Valid until the next call of latest().
  const PublishedAnswer& latest() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    }
    return slots_[front_];
  }

 private:
  static constexpr unsigned kIndex = 3;
  static constexpr unsigned kFresh = 4;  // the middle slot was not read yet

  std::array<PublishedAnswer, 3> slots_{};
  unsigned back_ = 0;           // publisher's
  std::uint64_t revision_ = 0;  // publisher's
  std::atomic<unsigned> middle_{1};
  unsigned front_ = 2;  // reader's
};

}  // namespace binpick::modbus
