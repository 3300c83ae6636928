#include "pose/score.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/report/score_log_odds.hpp"
#include "pose/score_weights.hpp"

namespace binpick {
namespace {

// What must be measured of a part before it counts fully.
constexpr double kMeasuredEnough = 0.35;
// Sensors miss some depth beside every edge. Where less than this share of the surface has depth,
// the part shines.
constexpr double kSurfaceKnown = 0.75;
// Shares below this are as good as none.
constexpr double kShareMin = 0.02;

// Of visible creases on an edge, where there is none to be seen: what says neither right nor wrong.
constexpr double kCreasesUnseen = 0.6;

// Of the surface that is usually known, the share that is. Where the image shows that something is
// there, depth that is missing beyond what is usual speaks neither for nor against it: what is
// measured speaks for the rest, if it is enough. Without an image nothing stands in for what was
// not measured, and without depth nothing is asked of it.
double known_share(const Evidence& e) {
  if (e.seen != Modality::kDepthAndIntensity) return 1;
  return std::clamp(e.known_fraction(), kMeasuredEnough, kSurfaceKnown) / kSurfaceKnown;
}

double log_share(double share) {
  return std::log(std::max(share, kShareMin));
}

double share(double part, int of) {
  return of > 0 ? part / of : 0;
}

const ScoreWeights& weights_of(Modality seen) {
  if (seen == Modality::kIntensity) return kScoreWeightsOfIntensityAlone;
  return seen == Modality::kDepth ? kScoreWeightsOfDepthAlone : kScoreWeights;
}

}  // namespace

ScoreTerms score_terms(const Evidence& e, double template_score) {
  ScoreTerms terms{};
  const auto set = [&](ScoreTerm term, double value) {
    terms[static_cast<std::size_t>(term)] = value;
  };
  set(ScoreTerm::kDepthSupport, log_share(e.depth_support()));
  set(ScoreTerm::kContourSupport, log_share(e.contour_support()));
  set(ScoreTerm::kMeasured, log_share(std::min(1.0, e.measured_fraction() / kMeasuredEnough)));
  const double area_px2 = e.explained_mm2 * e.px2_per_mm2 / known_share(e);
  set(ScoreTerm::kSupportedArea, std::log(std::max(1.0, area_px2)));
  set(ScoreTerm::kContradicted, share(e.contradicted, e.samples));
  set(ScoreTerm::kHidden, share(e.hidden, e.samples));
  set(ScoreTerm::kOutlineSteps, share(e.outline_steps, e.contours));
  set(ScoreTerm::kOutlineBare, share(e.outline_bare, e.contours));
  set(ScoreTerm::kOutlineOffset,
      e.outline_matches > 0 ? e.outline_offset_px / e.outline_matches : 0);
  set(ScoreTerm::kCreases, e.creases > 0 ? e.creases_supported / e.creases : kCreasesUnseen);
  set(ScoreTerm::kTemplate, template_score);
  return terms;
}

double log_odds(const ScoreTerms& terms, Modality seen) {
  const ScoreWeights& weights = weights_of(seen);
  double sum = weights.back();
  for (std::size_t i = 0; i < terms.size(); ++i) sum += weights[i] * terms[i];
  return sum;
}

double score_log_odds(const ScoreTerms& terms, Modality seen, const ModelTrials& trials) {
  const ScoreCalibration& part = trials.calibration_of(seen);
  return part.slope * log_odds(terms, seen) + part.offset;
}

double probability(const ScoreTerms& terms, Modality seen, const ModelTrials& trials) {
  return 1 / (1 + std::exp(-score_log_odds(terms, seen, trials)));
}

double conflicts_term(double log_odds, double conflict_odds) {
  return std::log1p(conflict_odds * std::exp(-log_odds));
}

}  // namespace binpick
