// How the score of one part is to be read: learnt from poses of which the truth is known.
#pragma once

#include <vector>

#include "binpick/model/model_trials.hpp"

namespace binpick::app {

struct JudgedScore {
  double score;  // probability as the evidence has it, not calibrated
  bool right;
};

// Slope and offset of the log odds by maximum likelihood (Platt scaling), held near 1 and 0 as far
// as the poses are few: a normal prior, so that with none it is the identity.
ScoreCalibration fit_calibration(const std::vector<JudgedScore>& poses);

}  // namespace binpick::app
