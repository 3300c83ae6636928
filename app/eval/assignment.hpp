// The two rules that every criterion of the scoring shares: which detection takes which instance,
// and the best F1 over a score threshold.
#pragma once

#include <vector>

#include "eval/score.hpp"

namespace binpick::app {

// The error of a detection against one instance.
struct PairError {
  int instance;
  double error;
};
// For each detection, in the order in which they choose, the instances that are worth comparing.
using PairErrors = std::vector<std::vector<PairError>>;

struct Match {
  Verdict verdict = Verdict::kWrong;
  int instance = -1;
};

// A detection fits an instance when its error is below `limit`. Each takes the best free instance
// that has to be found, else the best free other one and is neutral.
std::vector<Match> assign_greedily(PairErrors errors, const std::vector<bool>& target,
                                   double limit);

struct Scored {
  double score;
  Verdict verdict;
};

// `curve`, if given, receives a point for each threshold tried.
ThresholdScore best_over_thresholds(std::vector<Scored> detections, int instances,
                                    std::vector<CurvePoint>* curve);

ThresholdScore score_at_threshold(const std::vector<Scored>& detections, int instances,
                                  double threshold);

}  // namespace binpick::app
