// What people and logs call the station's orders, causes and states.
#include <span>

#include "station/cycle_result.hpp"

namespace binpick::app {
namespace {

namespace map = modbus::map;

const char* name_in(std::span<const map::NamedValue> names, int value) {
  for (const map::NamedValue& known : names) {
    if (known.value == value) return known.name;
  }
  return "unknown";
}

}  // namespace

const char* cause_name(Cause cause) {
  return name_in(map::kCauseNames, static_cast<int>(cause));
}

const char* order_name(OrderCode code) {
  return name_in(map::kCommandCodeNames, static_cast<int>(code));
}

const char* station_state_name(StationState state) {
  constexpr const char* kNames[] = {"idle", "grabbing", "computing", "done", "fault"};
  return kNames[static_cast<int>(state)];
}

void write_error(const Error& error, FixedText& text) {
  if (error.code != ErrorCode::kFrameTooLarge) return text.add(error_message(error.code));
  text.print("a frame is %lldx%lld px: raise sensor.width_max and sensor.height_max",
             error.detail >> 16, error.detail & 0xFFFF);
}

}  // namespace binpick::app
