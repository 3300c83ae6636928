// Curves of a sweep as text, HTML and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/sweep.hpp"

namespace binpick::app {

// A table for each disturbance: a line a part, a column a level. `noise_mm`: what level 1 of the
// noise is; 0: not known. Curves over more levels than fit a line are left out.
std::string sweep_table(const std::vector<SweepCurves>& curves, double noise_mm);

std::string sweep_section_html(const std::vector<SweepCurves>& curves, double noise_mm);

nlohmann::json sweep_to_json(const std::vector<SweepCurves>& curves, double noise_mm);

}  // namespace binpick::app
