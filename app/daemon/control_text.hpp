// The control socket's language: one line asks, one line of JSON answers. Pure.
#pragma once

#include <string>
#include <string_view>

#include "daemon/result_board.hpp"

namespace binpick::app {

struct ControlRequest {
  enum class Kind { kOrder, kStatus, kRecord, kHelp, kWrong };
  Kind kind = Kind::kWrong;
  Order order;        // of kOrder; source and time are the caller's to fill in
  std::string fault;  // of kWrong
};

// "detect recipe=2 picks=5 deadline_ms=300", "capture", "process", "recipe 2", "page 3",
// "next_page", "clear_fault", "free_run on", "free_run off", "flush", "record", "status", "help".
ControlRequest parse_control_line(std::string_view line);

std::string result_json(const CycleResult& result);
std::string status_json(const StationStatus& status, const char* sensor_state,
                        const CycleResult& last);
std::string fault_json(std::string_view fault);
// Of an order that was not taken.
std::string refusal_json(Cause cause, std::string_view fault);
extern const char* const kControlHelp;

}  // namespace binpick::app
