// Whether the PLC's heartbeat moves. Watched from its first change on, so that a PLC program
// without one is not called lost. Thread: seen() by the server's, state() by anybody.
#pragma once

#include <atomic>
#include <cstdint>

namespace binpick::modbus {

enum class Heartbeat { kNever, kAlive, kLost };

class HeartbeatWatch {
 public:
  // 0: never called lost.
  explicit HeartbeatWatch(int timeout_ms) : timeout_ns_(std::int64_t{timeout_ms} * 1'000'000) {}

  void seen(std::uint16_t value, std::int64_t now_ns) {
    if (value == value_) return;
    value_ = value;
    changed_ns_.store(now_ns, std::memory_order_relaxed);
  }

  Heartbeat state(std::int64_t now_ns) const {
    const std::int64_t changed_ns = changed_ns_.load(std::memory_order_relaxed);
    if (changed_ns == 0) return Heartbeat::kNever;
    const bool late = timeout_ns_ > 0 && now_ns - changed_ns > timeout_ns_;
    return late ? Heartbeat::kLost : Heartbeat::kAlive;
  }

 private:
  std::int64_t timeout_ns_;
  std::uint16_t value_ = 0;  // the server's thread only
  std::atomic<std::int64_t> changed_ns_{0};
};

}  // namespace binpick::modbus
