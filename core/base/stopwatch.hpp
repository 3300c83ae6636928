// Time since it was made, by the clock that the program handed in.
#pragma once

#include "binpick/base/clock.hpp"

namespace binpick {

class Stopwatch {
 public:
  explicit Stopwatch(ClockFn clock) : clock_(clock), start_ns_(clock ? clock() : 0) {}
  double elapsed_ms() const {  // 0 without a clock
    return clock_ ? static_cast<double>(clock_() - start_ns_) * 1e-6 : 0;
  }

 private:
  ClockFn clock_;
  std::int64_t start_ns_;
};

}  // namespace binpick
