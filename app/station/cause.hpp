// How an order ended, and why there are no more picks. The register map is the one place where the
// numbers are written down: they are never reused and never change their meaning.
#pragma once

#include "modbus/register_map.hpp"

namespace binpick::app {

using Cause = modbus::map::Cause;
using NoPickReason = modbus::map::NoPickReasonsBit;

const char* cause_name(Cause cause);  // snake_case, as in the register map

constexpr bool is_done(Cause cause) {
  return cause == Cause::kDone || cause == Cause::kCutShort;
}
// Nothing was done.
constexpr bool is_refusal(Cause cause) {
  return static_cast<int>(cause) >= 100 && static_cast<int>(cause) < 200;
}
// The station is in the fault state.
constexpr bool is_fault(Cause cause) {
  return static_cast<int>(cause) >= 200;
}

}  // namespace binpick::app
