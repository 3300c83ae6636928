#include "genicam/hole_marks.hpp"

#include <cstring>

namespace binpick::drivers {

// The finalizer of splitmix64: no runs of equal bytes, which images are full of.
HoleMarks::HoleMarks(std::uint64_t seed) : value_(seed + 0x9E3779B97F4A7C15u) {
  value_ = (value_ ^ value_ >> 30) * 0xBF58476D1CE4E5B9u;
  value_ = (value_ ^ value_ >> 27) * 0x94D049BB133111EBu;
  value_ ^= value_ >> 31;
}

void HoleMarks::mark(std::span<std::uint8_t> buffer) const {
  for (std::size_t at = 0; at + sizeof value_ <= buffer.size(); at += kSpacing)
    std::memcpy(buffer.data() + at, &value_, sizeof value_);
}

bool HoleMarks::any_left(std::span<const std::uint8_t> received) const {
  bool left = false;
  for (std::size_t at = 0; at + sizeof value_ <= received.size(); at += kSpacing) {
    std::uint64_t found;
    std::memcpy(&found, received.data() + at, sizeof found);
    left |= found == value_;
  }
  return left;
}

bool HoleMarks::any_written_over(std::span<const std::uint8_t> buffer) const {
  for (std::size_t at = 0; at + sizeof value_ <= buffer.size(); at += kSpacing) {
    if (std::memcmp(buffer.data() + at, &value_, sizeof value_) != 0) return true;
  }
  return false;
}

}  // namespace binpick::drivers
