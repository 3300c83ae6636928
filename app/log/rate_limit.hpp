// How often each kind of message may be said: so many in a stretch of time; the others are counted,
// and the count is told with the next one. A kind is known by the address of its literal.
// Thread-safe, lock-free; a table of fixed size, and kinds beyond it share its last place.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace binpick::app {

struct RateLimitParams {
  int burst = 20;  // 0: no limit
  std::int64_t interval_ns = 10'000'000'000;
};

class RateLimit {
 public:
  explicit RateLimit(const RateLimitParams& params) : params_(params) {}

  // False: not now. True: `suppressed` is how many were not said since the last one.
  bool passes(const char* kind, std::int64_t now_ns, std::uint64_t& suppressed) {
    suppressed = 0;
    if (params_.burst <= 0) return true;
    Kind& k = find(kind);
    std::int64_t since = k.since_ns.load(std::memory_order_relaxed);
    // Whoever moves the stretch on starts its count.
    if ((since == 0 || now_ns - since >= params_.interval_ns) &&
        k.since_ns.compare_exchange_strong(since, now_ns, std::memory_order_relaxed))
      k.said.store(0, std::memory_order_relaxed);
    if (k.said.fetch_add(1, std::memory_order_relaxed) >= params_.burst) {
      k.suppressed.fetch_add(1, std::memory_order_relaxed);
      suppressed_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    suppressed = k.suppressed.exchange(0, std::memory_order_relaxed);
    return true;
  }
  std::uint64_t suppressed_count() const { return suppressed_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kKinds = 64;
  struct Kind {
    std::atomic<const char*> name{nullptr};
    std::atomic<std::int64_t> since_ns{0};
    std::atomic<std::int64_t> said{0};
    std::atomic<std::uint64_t> suppressed{0};
  };

  Kind& find(const char* name) {
    for (Kind& kind : kinds_) {
      const char* there = kind.name.load(std::memory_order_relaxed);
      if (there == nullptr &&
          kind.name.compare_exchange_strong(there, name, std::memory_order_relaxed))
        return kind;
      if (there == name) return kind;
    }
    return kinds_.back();
  }

  RateLimitParams params_;
  std::array<Kind, kKinds> kinds_;
  std::atomic<std::uint64_t> suppressed_{0};
};

}  // namespace binpick::app
