// The faults that a simulated sensor shows, set by command line and while it runs. Each is one
// number: a probability, a switch, milliseconds or seconds; 0 is no fault.
// Thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>

namespace binpick::sim {

enum Fault : int {
  // Each packet, with the probability given.
  kLoss,
  kReorder,
  kDuplicate,
  kTruncate,
  kCorrupt,
  kWrongId,
  kWrongSize,
  // Each frame, with the probability given.
  kLyingOffset,
  kLyingSize,
  kLyingWidth,
  kLyingHeight,
  kShortPayload,
  kWrongTrailer,
  kTrailerStatus,
  // Switches.
  kFrozen,
  kHung,
  kStall,
  kRefuse,
  kStopStream,
  // Times.
  kSlow,  // ms
  kIdle,  // s
  kFaultCount,
};

enum FaultUse : unsigned { kAtGigE = 1, kAtUsb3 = 2 };

struct FaultKind {
  const char* name;
  unsigned use;
  double max;
  const char* help;
};

const FaultKind& fault_kind(Fault fault);

// What --help says of the faults that this kind of sensor has.
std::string fault_help(FaultUse use);

class FaultBoard {
 public:
  explicit FaultBoard(FaultUse use) : use_(use) {}

  double value(Fault fault) const {
    return values_[static_cast<std::size_t>(fault)].load(std::memory_order_relaxed);
  }
  bool on(Fault fault) const { return value(fault) != 0; }

  // "NAME VALUE"; "" when done, else what is wrong with it.
  std::string set(const std::string& name, const std::string& value);
  void clear();
  // "loss=0.05 slow=20", of the faults that are on.
  std::string text() const;

 private:
  FaultUse use_;
  std::array<std::atomic<double>, kFaultCount> values_{};
};

// Dice for faults: xorshift, so that a seed gives the same faults again. Thread: one.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
  bool falls(double probability) {
    if (probability <= 0) return false;
    return static_cast<double>(next() >> 11) * 0x1p-53 < probability;
  }
  std::uint64_t next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return state_;
  }

 private:
  std::uint64_t state_;
};

}  // namespace binpick::sim
