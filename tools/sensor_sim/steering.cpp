#include "steering.hpp"

#include <unistd.h>

#include <sstream>
#include <stdexcept>

namespace binpick::sim {
namespace {

std::string answer_of(const std::string& wrong) {
  return wrong.empty() ? "ok" : "err " + wrong;
}

// "NAME=VALUE" in two.
std::pair<std::string, std::string> split(const std::string& text) {
  const std::size_t equal = text.find('=');
  return {text.substr(0, equal), equal == std::string::npos ? "" : text.substr(equal + 1)};
}

}  // namespace

std::optional<SteeringLine> parse_line(const std::string& line) {
  std::istringstream words(line);
  SteeringLine parsed;
  std::string surplus;
  words >> parsed.verb >> parsed.first >> parsed.second >> surplus;
  if (!surplus.empty()) return std::nullopt;
  return parsed;
}

void set_at_start(const std::vector<std::string>& faults,
                  const std::vector<std::string>& false_values, FaultBoard& board, Sensor& sensor) {
  for (const std::string& fault : faults) {
    const auto [name, value] = split(fault);
    const std::string wrong = board.set(name, value);
    if (!wrong.empty()) throw std::runtime_error("--fault " + fault + ": " + wrong);
  }
  for (const std::string& lie : false_values) {
    const auto [feature, value] = split(lie);
    const std::string wrong = sensor.tell_falsely(feature, value);
    if (!wrong.empty()) throw std::runtime_error("--false " + lie + ": " + wrong);
  }
}

std::optional<std::string> steer(const SteeringLine& line, FaultBoard& board, Sensor& sensor,
                                 Acquisition& acquisition) {
  const auto& [verb, first, second] = line;
  if (verb == "fault" && !second.empty()) return answer_of(board.set(first, second));
  if (verb == "false" && !second.empty()) return answer_of(sensor.tell_falsely(first, second));
  if (verb == "clear" && first.empty()) {
    board.clear();
    sensor.tell_the_truth();
    return "ok";
  }
  if (verb == "trigger" && (first.empty() || first == "Line0" || first == "Line1")) {
    acquisition.trigger(first == "Line1" ? kSourceLine1 : kSourceLine0);
    return "ok";
  }
  if (verb == "kill") _exit(137);
  return std::nullopt;
}

}  // namespace binpick::sim
