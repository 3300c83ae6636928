// An evaluation as JSON: the scores, and for each frame what the detector reported about its run.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "eval/evaluation.hpp"
#include "eval/score.hpp"

namespace binpick::app {

nlohmann::json eval_to_json(const ScoreReport& score, const EvalRun& run,
                            const std::vector<ModelOrigin>& models,
                            const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace binpick::app
