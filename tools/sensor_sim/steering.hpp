// What all simulators understand alike: faults and false values at the start, and the lines that
// steer them while they run.
// Thread: the one that polls.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition.hpp"
#include "fault_board.hpp"
#include "sensor.hpp"

namespace binpick::sim {

// A line of at most three words; those that are not there are empty.
struct SteeringLine {
  std::string verb, first, second;
};
// Nothing when there are more words.
std::optional<SteeringLine> parse_line(const std::string& line);

// Each is "NAME=VALUE". Throws std::runtime_error that names the option and what is wrong.
void set_at_start(const std::vector<std::string>& faults,
                  const std::vector<std::string>& false_values, FaultBoard& board, Sensor& sensor);

// The answer to fault, false, clear, trigger and kill; nothing for a line of another kind.
std::optional<std::string> steer(const SteeringLine& line, FaultBoard& board, Sensor& sensor,
                                 Acquisition& acquisition);

}  // namespace binpick::sim
