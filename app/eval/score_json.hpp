// Scores as JSON, for the files that eval and score write.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "eval/score.hpp"

namespace binpick::app {

// {criterion, parts, mean, mixed, mixed_mean}; a value that does not exist is null.
nlohmann::json score_to_json(const ScoreReport& report);

}  // namespace binpick::app
