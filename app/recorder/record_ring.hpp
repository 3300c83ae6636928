// The last orders, copied into memory of fixed size. One thread puts records in and never waits: a
// full ring loses its oldest record that nobody is just writing, counted where it was still to be
// written. What has no frame has places of its own, so that turning pages pushes no frame out.
// Another thread takes out what is to be written. No lock: the writer may be kept from its
// processor for as long as others need it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "recorder/cycle_record.hpp"

namespace binpick::app {

struct RecordRingParams {
  int slot_count = 8;  // with a frame, 2 .. RecordRing::kSlotsMax
  int width_max = 0, height_max = 0;
  // Without a frame, 2 .. RecordRing::kSlotsMax; 0: those take the others' places.
  int frameless_count = 0;
};

// A record in the ring.
struct KeptRecord {
  static constexpr int kRegistersMax = 128, kTimesMax = 16;

  std::uint64_t number = 0;  // counts records, from 1
  std::uint64_t cycle = 0;
  std::int64_t unix_ns = 0;
  int cause = 0;
  const char* cause_name = "";
  const char* order_name = "";
  int recipe_selected = 0;
  bool fault = false;
  int configuration = 0;
  std::array<std::uint16_t, kRegistersMax> command{}, answer{};
  int command_count = 0, answer_count = 0;
  std::array<RecordedTime, kTimesMax> times{};
  int time_count = 0;
  Frame frame;  // without pixels; width 0: no frame
  std::span<std::uint16_t> depth_codes;
  std::span<std::uint8_t> intensity;
  bool has_depth = false, has_intensity = false;

  bool has_frame() const { return frame.camera.width > 0; }
  std::span<const std::uint16_t> frame_codes() const { return depth_codes.first(pixel_count()); }
  std::span<const std::uint8_t> frame_intensity() const { return intensity.first(pixel_count()); }
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(frame.camera.width) *
           static_cast<std::size_t>(frame.camera.height);
  }
};

class RecordRing {
 public:
  static constexpr int kSlotsMax = 64;

  static std::size_t footprint(const RecordRingParams& params);
  RecordRing(const RecordRingParams& params, Arena& arena);

  // Thread: the cycle's. `wanted`: it is to be written; else it is kept for keep_all_wanted().
  // Copies; a frame that is too large is left out and counted.
  void put(const CycleRecord& record, int configuration, bool wanted);
  // All that is in the ring and was never written is to be written. Any thread.
  void want_all();

  // Thread: the writer's. The oldest record that is to be written; nullptr: there is none. It stays
  // as it is until give_back().
  const KeptRecord* take();
  void give_back(const KeptRecord* record);

  std::uint64_t overwritten_count() const { return overwritten_.load(std::memory_order_relaxed); }
  std::uint64_t too_large_count() const { return too_large_.load(std::memory_order_relaxed); }

 private:
  enum class State : int {
    kFree,     // never used, or written
    kFilling,  // put() copies into it
    kKept,     // not to be written so far
    kWanted,   // to be written
    kTaken,    // being written
  };
  struct Slot {
    std::atomic<State> state{State::kFree};
    std::atomic<std::uint64_t> number{0};  // of the record; 0: none
    KeptRecord record;
  };
  std::span<Slot> slots() { return std::span(slots_).first(slot_count_ + frameless_count_); }
  Slot& claim_oldest(std::span<Slot> among);
  void copy(const CycleRecord& record, KeptRecord& kept);

  std::array<Slot, 2 * kSlotsMax> slots_;  // first those with a frame
  std::size_t slot_count_, frameless_count_;
  std::uint64_t number_ = 0;  // put()'s own
  std::atomic<std::uint64_t> overwritten_{0}, too_large_{0};
};

}  // namespace binpick::app
