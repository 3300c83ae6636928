// The reliability of the score as text, as a section of the report, and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/reliability.hpp"

namespace binpick::app {

// A line per part, then the bins of all poses together.
std::string reliability_table(const std::vector<Reliability>& parts);

// With a diagram per part. Empty where nothing was found.
std::string reliability_section_html(const std::vector<Reliability>& parts);

nlohmann::json reliability_to_json(const std::vector<Reliability>& parts);

}  // namespace binpick::app
