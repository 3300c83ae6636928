// The clock that stage times are measured with.
#pragma once

#include <chrono>
#include <cstdint>

namespace binpick::app {

// Monotonic; its zero means nothing.
inline std::int64_t monotonic_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace binpick::app
