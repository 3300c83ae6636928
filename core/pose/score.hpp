// From evidence to one number that means the same for every part: the probability that a pose is
// right. Each kind of evidence is a term, the weighted sum of the terms is the log odds: a logistic
// model, whose weights (score_weights.hpp) are fitted once, over piles of plain parts, by
// tools/calibration; none of the development piles' parts is among them. The terms are shares and
// logarithms of shares, or pixels, so nothing in them depends on a part's size, its distance or the
// camera. Frames without intensity, and frames without depth, have weights of their own: what they
// cannot show counts neither way.
#pragma once

#include <array>

#include "binpick/model/model_trials.hpp"
#include "binpick/report/detection.hpp"
#include "pose/verify.hpp"

namespace binpick {

// `template_score`: of the matched leaf, both modalities, 0..2; without depth 0..1.
ScoreTerms score_terms(const Evidence& evidence, double template_score);
// 1 / (1 + e^-log odds); the log odds are the weighted sum of the terms, calibrated for the part.
double probability(const ScoreTerms& terms, Modality seen, const ModelTrials& trials);

}  // namespace binpick
