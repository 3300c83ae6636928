// A check for numeric options: CLI::Range lets NaN pass and prints numbers with six decimals.
#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace binpick::app {

template <class T>
CLI::Validator number_between(T min, T max) {
  std::ostringstream range;
  range << min << " to " << max;
  const auto check = [min, max, text = range.str()](std::string& input) -> std::string {
    T value{};
    const bool inside = CLI::detail::lexical_cast(input, value) && value >= min && value <= max;
    return inside ? "" : "'" + input + "': expected a number from " + text;
  };
  return CLI::Validator(check, range.str());
}

}  // namespace binpick::app
