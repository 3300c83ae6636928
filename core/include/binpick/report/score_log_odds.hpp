// What a pose's score would be with other terms: tells which of them a low score is owed to.
#pragma once

#include "binpick/frame/modality.hpp"
#include "binpick/model/model_trials.hpp"
#include "binpick/report/detection.hpp"

namespace binpick {

// Log odds of the score that a pose with these terms gets. `seen`: the images that it was found in.
double score_log_odds(const ScoreTerms& terms, Modality seen, const ModelTrials& trials);

}  // namespace binpick
