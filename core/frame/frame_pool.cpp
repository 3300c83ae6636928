#include "binpick/frame/frame_pool.hpp"

#include <bit>

#include "binpick/base/arena_plan.hpp"

namespace binpick {
namespace {

std::uint64_t mask_of(int slot_count) {
  return slot_count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << slot_count) - 1;
}

std::size_t pixel_count(const FramePoolParams& params) {
  return static_cast<std::size_t>(params.width_max) * static_cast<std::size_t>(params.height_max);
}

// The same list for the plan and for the arena.
template <class Memory>
std::span<FrameSlot> take_slots(Memory& memory, const FramePoolParams& params) {
  BINPICK_ASSERT(params.slot_count >= 1 && params.slot_count <= FramePool::kSlotsMax);
  BINPICK_ASSERT(params.width_max > 0 && params.height_max > 0);
  const auto slots = memory.template take<FrameSlot>(params.slot_count);
  for (int i = 0; i < params.slot_count; ++i) {
    const auto depth_mm = memory.template take<float>(pixel_count(params));
    const auto intensity = memory.template take<std::uint8_t>(pixel_count(params));
    if (!slots.empty()) slots[i] = {depth_mm, intensity, {}};
  }
  return slots;
}

}  // namespace

const Frame& FrameRef::frame() const {
  BINPICK_ASSERT(pool_ != nullptr);
  return pool_->slots_[index_].frame;
}

FrameSlot& FrameRef::slot() {
  BINPICK_ASSERT(pool_ != nullptr);
  return pool_->slots_[index_];
}

void FrameRef::reset() {
  if (pool_ != nullptr) std::exchange(pool_, nullptr)->give_back(index_);
}

std::size_t FramePool::footprint(const FramePoolParams& params) {
  ArenaPlan plan;
  take_slots(plan, params);
  return plan.bytes;
}

FramePool::FramePool(const FramePoolParams& params, Arena& arena)
    : params_(params), slots_(take_slots(arena, params)), free_mask_(mask_of(params.slot_count)) {}

FramePool::~FramePool() {
  BINPICK_ASSERT(free_mask_.load(std::memory_order_acquire) == mask_of(params_.slot_count));
}

FrameRef FramePool::try_take() {
  std::uint64_t mask = free_mask_.load(std::memory_order_relaxed);
  while (mask != 0) {
    const std::uint64_t without_lowest = mask & (mask - 1);
    // Acquire: the last holder's reads are over before the new one writes.
    if (free_mask_.compare_exchange_weak(mask, without_lowest, std::memory_order_acquire,
                                         std::memory_order_relaxed)) {
      const int index = std::countr_zero(mask);
      slots_[index].frame = Frame{};
      return FrameRef(this, index);
    }
  }
  exhausted_.fetch_add(1, std::memory_order_relaxed);
  return {};
}

int FramePool::free_count() const {
  return std::popcount(free_mask_.load(std::memory_order_relaxed));
}

void FramePool::give_back(int index) {
  const std::uint64_t bit = std::uint64_t{1} << index;
  const std::uint64_t before = free_mask_.fetch_or(bit, std::memory_order_release);
  BINPICK_ASSERT((before & bit) == 0);
}

}  // namespace binpick
