#include "assess/score_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "binpick/report/score_log_odds.hpp"
#include "eval/html_text.hpp"

namespace binpick::app {
namespace {

constexpr double kHiddenMuch = 0.3, kMissingMuch = 0.25;
// A cause has to cost this share of all that is lost, and so much in log odds.
constexpr double kCostShare = 0.25, kCostMin = 0.3;
constexpr std::size_t kCausesPerPart = 2;
// Residuals that the noise alone does not explain (the median of noise is 0.67 of its deviation).
constexpr double kResidualPerNoise = 2;
constexpr double kTopShare = 0.1;

double value_of(const ScoreTerms& terms, ScoreTerm which) {
  return terms[static_cast<std::size_t>(which)];
}

std::string share_text(double share) {
  return fixed_digits(100 * share, 0) + " %";
}

ScoreLimit limit_of(ScoreTerm which, const PartEvidence& part) {
  switch (which) {
    case ScoreTerm::kDepthSupport:
      return ScoreLimit::kOffSurface;
    case ScoreTerm::kMeasured:
      return ScoreLimit::kMissingDepth;
    case ScoreTerm::kSupportedArea:
      if (value_of(part.terms, ScoreTerm::kHidden) > kHiddenMuch) return ScoreLimit::kHidden;
      return part.missing_share > kMissingMuch ? ScoreLimit::kMissingDepth : ScoreLimit::kSmall;
    case ScoreTerm::kContradicted:
      return ScoreLimit::kBehind;
    case ScoreTerm::kHidden:
      return ScoreLimit::kHidden;
    case ScoreTerm::kOutlineOffset:
      return ScoreLimit::kOffset;
    case ScoreTerm::kConflicts:
      return ScoreLimit::kConflicts;
    case ScoreTerm::kContourSupport:
    case ScoreTerm::kOutlineSteps:
    case ScoreTerm::kOutlineBare:
    case ScoreTerm::kCreases:
    case ScoreTerm::kTemplate:
      break;
  }
  return ScoreLimit::kOutline;
}

struct PartLimit {
  ScoreLimit limit;
  double cost;
};

std::vector<PartLimit> limits_of(const PartEvidence& part, const LimitContext& context) {
  if (!part.low) return {{ScoreLimit::kSearch, 0}};
  const ScoreTerms costs = score_costs(part.terms, context);
  std::array<double, kScoreLimitCount> sums{};
  for (int i = 0; i < kScoreTermCount; ++i) {
    const double cost = costs[static_cast<std::size_t>(i)];
    if (cost > 0) sums[static_cast<std::size_t>(limit_of(static_cast<ScoreTerm>(i), part))] += cost;
  }
  const double all = std::accumulate(sums.begin(), sums.end(), 0.0);
  std::vector<PartLimit> out;
  for (int i = 0; i < kScoreLimitCount; ++i) {
    const double cost = sums[static_cast<std::size_t>(i)];
    if (cost >= kCostMin && cost >= kCostShare * all)
      out.push_back({static_cast<ScoreLimit>(i), cost});
  }
  std::ranges::sort(out, std::greater{}, &PartLimit::cost);
  if (out.size() > kCausesPerPart) out.resize(kCausesPerPart);
  const double best = score_log_odds(context.best, context.seen, context.trials);
  const double wanted = std::log(context.threshold / (1 - context.threshold));
  if (best < wanted) out.push_back({ScoreLimit::kCalibration, wanted - best});
  return out;
}

// Means over the parts of a finding.
struct Means {
  double hidden = 0, missing = 0, residual_mm = 0, area_px = 0, contour = 0, offset_px = 0,
         behind = 0;
};

std::string depth_text(const Means& m, double noise_mm) {
  const std::string off =
      "the measured surface lies " + fixed_digits(m.residual_mm, 2) + " mm (median) off the CAD's";
  if (noise_mm <= 0)
    return off + ": use the CAD of the part as it is made, and check the sensor's calibration";
  const std::string noise = fixed_digits(noise_mm, 2) + " mm";
  if (m.residual_mm > kResidualPerNoise * noise_mm)
    return off + ", while a pixel's depth scatters by only " + noise +
           ": use the CAD of the part as it is made, and check unit, depth scale and the sensor's "
           "calibration";
  return off + ", which is the depth noise (" + noise +
         " from frame to frame): let the sensor average or expose longer, or mount it nearer";
}

std::string text_of(ScoreLimit limit, const Means& m, const LimitContext& context) {
  switch (limit) {
    case ScoreLimit::kHidden:
      return share_text(m.hidden) +
             " of the surface is hidden by what lies in front: nothing to mend, its turn comes "
             "when that is picked";
    case ScoreLimit::kMissingDepth:
      return share_text(m.missing) +
             " of the visible surface has no depth: expose longer or with more projector light; "
             "for shiny or dark parts use several exposures (HDR) or tilt the sensor";
    case ScoreLimit::kSmall:
      return "the pose explains only " + fixed_digits(m.area_px, 0) +
             " pixels, where well seen parts explain " +
             fixed_digits(std::exp(value_of(context.best, ScoreTerm::kSupportedArea)), 0) +
             ": it shows its small side or is cut off; a sensor mounted nearer or a higher "
             "resolution would help";
    case ScoreLimit::kOffSurface:
      return depth_text(m, context.noise_mm);
    case ScoreLimit::kOutline:
      return "only " + share_text(m.contour) +
             " of the visible outline lies on an edge: check exposure, contrast to the "
             "background and focus, and that the CAD is the part's";
    case ScoreLimit::kOffset:
      return "edges in the image lie " + fixed_digits(m.offset_px, 1) +
             " px beside the outline: check focus, motion blur, and that depth and intensity are "
             "registered (intrinsics, distortion)";
    case ScoreLimit::kBehind:
      return "at " + share_text(m.behind) +
             " of the surface the sensor measures something behind it: the pose is wrong there, "
             "or the part lacks what its CAD has (bent, cut, another variant)";
    case ScoreLimit::kConflicts:
      return "other poses explain the same pixels nearly as well: where the gripper does not mind "
             "how the part is turned use --near-symmetry equivalent; else a view or a resolution "
             "that shows the difference";
    case ScoreLimit::kCalibration:
      return "with the best evidence seen here the score would be " +
             fixed_digits(
                 1 / (1 + std::exp(-score_log_odds(context.best, context.seen, context.trials))),
                 2) +
             ": the calibration of the model holds it down, since poses of this part were often "
             "wrong in its simulated piles; retrain with --camera and --distance-mm of this cell "
             "and with more --calibration-piles, or use the threshold suggested here";
    case ScoreLimit::kSearch:
      return "it is not found in every frame, but then with the threshold's score: the search "
             "loses it, not its score; less depth noise (averaging, exposure) helps, or training "
             "for the distances and tilts of this cell only";
  }
  return {};
}

Means means_of(const std::vector<const PartEvidence*>& parts) {
  Means m;
  const auto count = static_cast<double>(parts.size());
  for (const PartEvidence* p : parts) {
    m.hidden += value_of(p->terms, ScoreTerm::kHidden) / count;
    m.missing += p->missing_share / count;
    m.residual_mm += p->residual_mm / count;
    m.area_px += std::exp(value_of(p->terms, ScoreTerm::kSupportedArea)) / count;
    m.contour += std::exp(value_of(p->terms, ScoreTerm::kContourSupport)) / count;
    m.offset_px += value_of(p->terms, ScoreTerm::kOutlineOffset) / count;
    m.behind += value_of(p->terms, ScoreTerm::kContradicted) / count;
  }
  return m;
}

}  // namespace

const char* score_limit_name(ScoreLimit limit) {
  static constexpr const char* kNames[kScoreLimitCount] = {
      "hidden", "missing_depth", "small",     "off_surface", "outline",
      "offset", "behind",        "conflicts", "calibration", "search"};
  return kNames[static_cast<std::size_t>(limit)];
}

ScoreTerms best_terms(std::span<const ScoreTerms> poses) {
  ScoreTerms best{};
  best[static_cast<std::size_t>(ScoreTerm::kOutlineSteps)] = 1;
  for (const ScoreTerm which :
       {ScoreTerm::kSupportedArea, ScoreTerm::kCreases, ScoreTerm::kTemplate}) {
    std::vector<double> values;
    for (const ScoreTerms& terms : poses) values.push_back(value_of(terms, which));
    if (values.empty()) continue;
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(kTopShare * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end(), std::greater{});
    best[static_cast<std::size_t>(which)] = *at;
  }
  return best;
}

ScoreTerms score_costs(const ScoreTerms& terms, const LimitContext& context) {
  ScoreTerms costs{};
  const double odds = score_log_odds(terms, context.seen, context.trials);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    ScoreTerms better = terms;
    better[i] = context.best[i];
    costs[i] = score_log_odds(better, context.seen, context.trials) - odds;
  }
  return costs;
}

std::vector<LimitFinding> find_limits(std::span<const PartEvidence> parts,
                                      const LimitContext& context) {
  std::array<std::vector<const PartEvidence*>, kScoreLimitCount> of;
  std::array<double, kScoreLimitCount> costs{};
  for (const PartEvidence& part : parts) {
    for (const PartLimit& limit : limits_of(part, context)) {
      of[static_cast<std::size_t>(limit.limit)].push_back(&part);
      costs[static_cast<std::size_t>(limit.limit)] += limit.cost;
    }
  }
  std::vector<LimitFinding> out;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i].empty()) continue;
    LimitFinding finding{static_cast<ScoreLimit>(i), {}, 0, ""};
    for (const PartEvidence* part : of[i]) finding.parts.push_back(part->number);
    finding.cost = costs[i] / static_cast<double>(of[i].size());
    finding.text = text_of(finding.limit, means_of(of[i]), context);
    out.push_back(std::move(finding));
  }
  std::ranges::stable_sort(out, std::greater{},
                           [](const LimitFinding& f) { return std::pair(f.parts.size(), f.cost); });
  return out;
}

}  // namespace binpick::app
