// What the server has seen since start, for status pages and metrics. Written by the server's
// thread, read by anybody; each number is right by itself, together they may be a request apart.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace binpick::modbus {

enum class Count : std::size_t {
  kAccepted,
  kRefusedAddress,    // not on the allow-list
  kRefusedLimit,      // all places taken
  kReplacedByWriter,  // a connection that gave its place to the PLC's
  kClosedByClient,
  kClosedIdle,
  kClosedPartialFrame,  // a frame begun and not ended in time
  kClosedUnread,        // the client does not read its answers
  kWrongProtocol,       // closed: MBAP protocol id
  kWrongLength,         // closed: MBAP length
  kReadHolding,         // requests answered, by function
  kReadInput,
  kWriteOne,
  kWriteMany,
  kReadWriteMany,
  kIllegalFunction,  // exceptions, by code
  kIllegalAddress,
  kIllegalValue,
  kServerFailure,
  kTargetSilent,
  kCommands,      // commands that a changed sequence started
  kAcceptPaused,  // the process was out of file descriptors
};
inline constexpr std::size_t kCountNumber = static_cast<std::size_t>(Count::kAcceptPaused) + 1;
const char* count_name(Count count);  // snake_case

class ServerCounters {
 public:
  void add(Count count) {
    counts_[static_cast<std::size_t>(count)].fetch_add(1, std::memory_order_relaxed);
  }
  std::uint64_t operator[](Count count) const {
    return counts_[static_cast<std::size_t>(count)].load(std::memory_order_relaxed);
  }

 private:
  std::array<std::atomic<std::uint64_t>, kCountNumber> counts_{};
};

}  // namespace binpick::modbus
