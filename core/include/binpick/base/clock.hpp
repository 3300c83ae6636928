// Core reads no clock of its own: the program hands one in.
#pragma once

#include <cstdint>

namespace binpick {

// Monotonic time in ns. Null where no times are wanted: all of them are then 0.
using ClockFn = std::int64_t (*)();

}  // namespace binpick
