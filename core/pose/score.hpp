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
// The weighted sum of the terms.
double log_odds(const ScoreTerms& terms, Modality seen);
// 1 / (1 + e^-log odds), with the log odds calibrated for the part.
double probability(const ScoreTerms& terms, Modality seen, const ModelTrials& trials);

// The term of a pose in conflict with others: at most one of them is right, since they explain the
// same pixels. `conflict_odds`: the sum of theirs. Their ratio to its own odds is what counts:
// where a sensor shows all poses badly, the right one still stands out from the others.
double conflicts_term(double log_odds, double conflict_odds);

}  // namespace binpick
