// A fixed number of frame buffers of a fixed size, and FrameRef, which owns one of them until it is
// destroyed. Drivers take a slot, fill it and hand it on; nothing is ever added: where every slot
// is held the frame is dropped, and counted. Size the pool as the sum of its holders. Thread-safe
// and lock-free. All FrameRefs are gone before their pool is (asserted).
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>

#include "binpick/base/arena.hpp"
#include "binpick/frame/frame.hpp"

namespace binpick {

// One buffer. Who fills it sets `frame` to views of (a part of) the buffers.
struct FrameSlot {
  std::span<float> depth_mm;
  std::span<std::uint8_t> intensity;
  Frame frame;
};

struct FramePoolParams {
  int slot_count = 0;                 // 1 .. FramePool::kSlotsMax
  int width_max = 0, height_max = 0;  // px of the largest frame
};

class FramePool;

// Move-only; gives its slot back. An empty one owns nothing.
class FrameRef {
 public:
  FrameRef() = default;
  FrameRef(FrameRef&& other) noexcept
      : pool_(std::exchange(other.pool_, nullptr)), index_(other.index_) {}
  FrameRef& operator=(FrameRef&& other) noexcept {
    if (this != &other) {
      reset();
      pool_ = std::exchange(other.pool_, nullptr);
      index_ = other.index_;
    }
    return *this;
  }
  ~FrameRef() { reset(); }

  explicit operator bool() const { return pool_ != nullptr; }
  const Frame& frame() const;
  FrameSlot& slot();
  void reset();

 private:
  friend class FramePool;
  FrameRef(FramePool* pool, int index) : pool_(pool), index_(index) {}

  FramePool* pool_ = nullptr;
  int index_ = 0;
};

class FramePool {
 public:
  static constexpr int kSlotsMax = 64;

  // What the constructor takes from its arena.
  static std::size_t footprint(const FramePoolParams& params);
  FramePool(const FramePoolParams& params, Arena& arena);
  ~FramePool();
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;

  // A slot whose frame is blank; an empty FrameRef, counted, where every slot is held.
  FrameRef try_take();

  const FramePoolParams& params() const { return params_; }
  bool fits(int width, int height) const {
    return width > 0 && height > 0 && width <= params_.width_max && height <= params_.height_max;
  }
  int free_count() const;
  std::uint64_t exhausted_count() const { return exhausted_.load(std::memory_order_relaxed); }

 private:
  friend class FrameRef;
  void give_back(int index);

  FramePoolParams params_;
  std::span<FrameSlot> slots_;
  std::atomic<std::uint64_t> free_mask_;  // bit i: slot i is free
  std::atomic<std::uint64_t> exhausted_{0};
};

}  // namespace binpick
