// The order of a sensor's frames by their numbers, and how many of them never came.
// Thread: one at a time.
#pragma once

#include <cstdint>

namespace binpick::drivers {

class FrameOrder {
 public:
  // Whatever number comes next is the first.
  void clear() { *this = FrameOrder(); }
  // A frame came and was dropped before its number was looked at: it is one of those that lie
  // between the numbers, and not missing.
  void note_dropped() { ++dropped_; }
  // False: not newer than the frame before it. Else `missed` is how many between the two never
  // came. Numbers up to 65535 wrap, leaving 0 out; larger ones do not.
  bool advance(std::uint64_t number, std::uint64_t& missed);

 private:
  std::uint64_t last_ = 0;
  bool any_ = false;
  std::int64_t dropped_ = 0;  // since then
};

}  // namespace binpick::drivers
