#include "eval/assignment.hpp"

#include <algorithm>

namespace binpick::app {
namespace {

ThresholdScore from_counts(int right, int wrong, int instances) {
  ThresholdScore score;
  score.judged = right + wrong;
  const int sum = instances + right + wrong;
  score.f1 = sum > 0 ? 2.0 * right / sum : 0.0;
  score.recall = instances > 0 ? static_cast<double>(right) / instances : 0.0;
  score.precision = score.judged > 0 ? static_cast<double>(right) / score.judged : 0.0;
  return score;
}

}  // namespace

std::vector<Match> assign_greedily(PairErrors errors, const std::vector<bool>& target,
                                   double limit) {
  std::vector<bool> taken(target.size(), false);
  std::vector<Match> matches;
  for (std::vector<PairError>& fit : errors) {
    std::sort(fit.begin(), fit.end(), [](const PairError& a, const PairError& b) {
      return a.error != b.error ? a.error < b.error : a.instance < b.instance;
    });
    Match match;
    for (const PairError& p : fit) {
      if (p.error >= limit || taken[p.instance]) continue;
      if (target[p.instance]) {
        match = {Verdict::kRight, p.instance};
        break;
      }
      if (match.instance < 0) match = {Verdict::kNeutral, p.instance};
    }
    if (match.instance >= 0) taken[match.instance] = true;
    matches.push_back(match);
  }
  return matches;
}

ThresholdScore best_over_thresholds(std::vector<Scored> detections, int instances,
                                    std::vector<CurvePoint>* curve) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  ThresholdScore best;
  int right = 0, wrong = 0;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    right += detections[i].verdict == Verdict::kRight;
    wrong += detections[i].verdict == Verdict::kWrong;
    if (i + 1 < detections.size() && detections[i + 1].score == detections[i].score) continue;
    ThresholdScore here = from_counts(right, wrong, instances);
    if (curve != nullptr && right + wrong > 0) {
      curve->push_back({detections[i].score, here.recall, here.precision});
    }
    here.threshold = detections[i].score;
    if (here.f1 > best.f1) best = here;
  }
  return best;
}

ThresholdScore score_at_threshold(const std::vector<Scored>& detections, int instances,
                                  double threshold) {
  int right = 0, wrong = 0;
  for (const Scored& d : detections) {
    if (d.score < threshold) continue;
    right += d.verdict == Verdict::kRight;
    wrong += d.verdict == Verdict::kWrong;
  }
  ThresholdScore score = from_counts(right, wrong, instances);
  score.threshold = threshold;
  return score;
}

}  // namespace binpick::app
