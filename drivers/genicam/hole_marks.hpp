// Finds bytes of a frame that never arrived. A packet under a wrong number takes the place of
// another one, the sizes still add up, and the hole keeps what the buffer held before: a piece of
// an older frame. So each buffer is marked, every few hundred bytes, before it is filled; a mark
// that is still there afterwards was not written over. Holes shorter than kSpacing + 8 bytes may
// escape. Thread: one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace binpick::drivers {

class HoleMarks {
 public:
  // Smaller than half of the smallest packet's payload.
  static constexpr std::size_t kSpacing = 240;

  // `seed`: any number that no sensor can know.
  explicit HoleMarks(std::uint64_t seed);

  void mark(std::span<std::uint8_t> buffer) const;
  // Whether a mark is left in the bytes from the buffer's beginning on.
  bool any_left(std::span<const std::uint8_t> received) const;
  // Whether anything came at all.
  bool any_written_over(std::span<const std::uint8_t> buffer) const;

 private:
  std::uint64_t value_;
};

}  // namespace binpick::drivers
