// A point in time by which work has to end, by the clock that the program handed in.
#pragma once

#include "binpick/base/clock.hpp"

namespace binpick {

struct Deadline {
  ClockFn clock = nullptr;
  std::int64_t at_ns = 0;  // 0: none

  bool passed() const { return at_ns != 0 && clock && clock() >= at_ns; }
  // The point at which `share` of the time from now to the deadline is used up.
  Deadline after_share(double share) const {
    if (at_ns == 0 || !clock) return *this;
    const std::int64_t now = clock();
    return {clock, now + static_cast<std::int64_t>(static_cast<double>(at_ns - now) * share)};
  }
};

}  // namespace binpick
