// Tables of an evaluation as text for the console.
#pragma once

#include <string>
#include <vector>

#include "eval/run_summary.hpp"
#include "eval/score.hpp"

namespace binpick::app {

// A line per part: F1, precision, recall at the best threshold; mean absolute errors; ADD; times.
std::string score_table(const ScoreReport& report);

// A line per part: mean time of each stage.
std::string stage_table(const std::vector<RunLine>& lines);

// A line per part and tree depth: time, templates evaluated, candidates kept; then the drops.
std::string level_table(const std::vector<RunLine>& lines);

}  // namespace binpick::app
