// What people and logs call the station's orders and states.
#include "station/cycle_result.hpp"

namespace binpick::app {

const char* order_name(OrderCode code) {
  constexpr const char* kNames[] = {"none",           "detect",        "capture", "process",
                                    "select_recipe",  "next_page",     "page",    "clear_fault",
                                    "free_run_start", "free_run_stop", "flush"};
  const int index = static_cast<int>(code);
  return index >= 0 && index <= static_cast<int>(OrderCode::kFlush) ? kNames[index] : "unknown";
}

const char* station_state_name(StationState state) {
  constexpr const char* kNames[] = {"idle", "grabbing", "computing", "done", "fault"};
  return kNames[static_cast<int>(state)];
}

}  // namespace binpick::app
