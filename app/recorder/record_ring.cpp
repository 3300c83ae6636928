#include "recorder/record_ring.hpp"

#include <algorithm>
#include <limits>

#include "binpick/base/arena_plan.hpp"
#include "recorder/depth_codes.hpp"

namespace binpick::app {
namespace {

struct Pixels {
  std::span<std::uint16_t> depth_codes;
  std::span<std::uint8_t> intensity;
};

template <class Memory>
Pixels take_pixels(Memory& memory, const RecordRingParams& params) {
  const auto count =
      static_cast<std::size_t>(params.width_max) * static_cast<std::size_t>(params.height_max);
  return {memory.template take<std::uint16_t>(count), memory.template take<std::uint8_t>(count)};
}

int copy_registers(std::span<const std::uint16_t> from, std::span<std::uint16_t> to) {
  BINPICK_ASSERT(from.size() <= to.size());
  std::copy(from.begin(), from.end(), to.begin());
  return static_cast<int>(from.size());
}

}  // namespace

std::size_t RecordRing::footprint(const RecordRingParams& params) {
  ArenaPlan plan;
  for (int i = 0; i < params.slot_count; ++i) take_pixels(plan, params);
  return plan.bytes;
}

RecordRing::RecordRing(const RecordRingParams& params, Arena& arena)
    : slot_count_(static_cast<std::size_t>(params.slot_count)),
      frameless_count_(static_cast<std::size_t>(params.frameless_count)) {
  BINPICK_ASSERT(params.slot_count >= 2 && params.slot_count <= kSlotsMax);
  BINPICK_ASSERT(params.frameless_count != 1 && params.frameless_count >= 0 &&
                 params.frameless_count <= kSlotsMax);
  for (Slot& slot : slots().first(slot_count_)) {
    const Pixels pixels = take_pixels(arena, params);
    slot.record.depth_codes = pixels.depth_codes;
    slot.record.intensity = pixels.intensity;
  }
}

// The writer holds at most one slot, so there is always another one of two; each time that a claim
// fails the writer has just taken or given back a slot.
RecordRing::Slot& RecordRing::claim_oldest(std::span<Slot> among) {
  for (;;) {
    Slot* oldest = nullptr;
    auto state = State::kFree;
    auto oldest_number = std::numeric_limits<std::uint64_t>::max();
    for (Slot& slot : among) {
      const State now = slot.state.load(std::memory_order_acquire);
      // What was written goes first, whatever its age.
      const std::uint64_t number =
          now == State::kFree ? 0 : slot.number.load(std::memory_order_relaxed);
      if (now == State::kTaken || number >= oldest_number) continue;
      oldest = &slot;
      state = now;
      oldest_number = number;
    }
    if (oldest == nullptr) continue;
    if (!oldest->state.compare_exchange_strong(state, State::kFilling, std::memory_order_acquire))
      continue;
    if (state == State::kWanted) overwritten_.fetch_add(1, std::memory_order_relaxed);
    return *oldest;
  }
}

void RecordRing::copy(const CycleRecord& record, KeptRecord& kept) {
  kept.cycle = record.cycle;
  kept.unix_ns = record.unix_ns;
  kept.cause = record.cause;
  kept.cause_name = record.cause_name;
  kept.order_name = record.order_name;
  kept.recipe_selected = record.recipe_selected;
  kept.fault = record.fault;
  kept.command_count = copy_registers(record.command, kept.command);
  kept.answer_count = copy_registers(record.answer, kept.answer);
  const std::size_t times = std::min(record.times.size(), kept.times.size());
  std::copy_n(record.times.begin(), times, kept.times.begin());
  kept.time_count = static_cast<int>(times);
  kept.frame = Frame{};
  if (record.frame == nullptr) return;
  const Frame& frame = *record.frame;
  kept.has_depth = !frame.depth_mm.empty();
  kept.has_intensity = !frame.intensity.empty();
  const int width = kept.has_depth ? frame.depth_mm.width : frame.intensity.width;
  const int height = kept.has_depth ? frame.depth_mm.height : frame.intensity.height;
  const auto row_pixels = static_cast<std::size_t>(width);
  const std::size_t pixels = row_pixels * static_cast<std::size_t>(height);
  if (pixels == 0) return;
  if (pixels > kept.depth_codes.size()) {
    too_large_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  kept.frame = frame;
  kept.frame.depth_mm = {};
  kept.frame.intensity = {};
  kept.frame.camera.width = width;
  kept.frame.camera.height = height;
  if (frame.depth_scale_mm <= 0) kept.frame.depth_scale_mm = kDepthStep_mm;
  if (kept.has_depth) depth_codes(frame, kept.frame.depth_scale_mm, kept.depth_codes.first(pixels));
  for (int y = 0; kept.has_intensity && y < height; ++y)
    std::copy_n(frame.intensity.row(y), row_pixels,
                kept.intensity.data() + static_cast<std::size_t>(y) * row_pixels);
}

void RecordRing::put(const CycleRecord& record, int configuration, bool wanted) {
  const bool with_frame = record.frame != nullptr || frameless_count_ == 0;
  Slot& slot = claim_oldest(with_frame ? slots().first(slot_count_) : slots().subspan(slot_count_));
  copy(record, slot.record);
  slot.record.configuration = configuration;
  slot.record.number = ++number_;
  slot.number.store(number_, std::memory_order_relaxed);
  slot.state.store(wanted ? State::kWanted : State::kKept, std::memory_order_release);
}

void RecordRing::want_all() {
  for (Slot& slot : slots()) {
    State kept = State::kKept;
    slot.state.compare_exchange_strong(kept, State::kWanted, std::memory_order_acq_rel);
  }
}

const KeptRecord* RecordRing::take() {
  for (;;) {
    Slot* oldest = nullptr;
    auto oldest_number = std::numeric_limits<std::uint64_t>::max();
    for (Slot& slot : slots()) {
      if (slot.state.load(std::memory_order_acquire) != State::kWanted) continue;
      const std::uint64_t number = slot.number.load(std::memory_order_relaxed);
      if (number >= oldest_number) continue;
      oldest = &slot;
      oldest_number = number;
    }
    if (oldest == nullptr) return nullptr;
    State wanted = State::kWanted;
    if (oldest->state.compare_exchange_strong(wanted, State::kTaken, std::memory_order_acq_rel))
      return &oldest->record;
  }
}

void RecordRing::give_back(const KeptRecord* record) {
  for (Slot& slot : slots()) {
    if (&slot.record != record) continue;
    BINPICK_ASSERT(slot.state.load(std::memory_order_relaxed) == State::kTaken);
    slot.state.store(State::kFree, std::memory_order_release);
    return;
  }
  BINPICK_ASSERT(false);
}

}  // namespace binpick::app
