#include "eval/loss.hpp"

#include <algorithm>
#include <cmath>

#include "eval/html_text.hpp"

namespace binpick::app {
namespace {

// Less of its silhouette measured than this: there is nothing to go by.
constexpr double kMeasuredShareMin = 0.15;
// The truth's net advantage over another pose, as a share of what is seen of the part, below which
// the depth image does not tell the two apart. Poses 8 degrees apart of the parts of the sample
// data that can be told apart are above it (tests/app/tell_apart_test.cpp).
constexpr double kAdvantageMin = 0.01;
// Outlines count too: this much more of the truth's on edges tells it from the other pose.
constexpr double kContourAdvantageMin = 0.10;

std::string percent(double share) {
  return fixed_digits(100 * share, std::abs(share) < 0.1 ? 1 : 0) + " %";
}

std::string drop_text(DropReason reason) {
  std::string text = drop_reason_name(reason);
  for (char& c : text) c = c == '_' ? ' ' : c;
  return text;
}

bool told_apart(const PoseComparison& depth, double contour_truth, double contour_other) {
  return depth.advantage() > kAdvantageMin || contour_truth - contour_other > kContourAdvantageMin;
}

// kNone where the data tell the truth from whatever took its place, and where there is no depth to
// compare with.
LossCause what_data_hide(const TargetFinding& t) {
  const ReferenceFinding& f = t.finding;
  const double contour = f.from_truth.detection.contour_support;
  if (t.moved.silhouette_px == 0) return {};
  if (t.moved.measured_share() < kMeasuredShareMin) {
    return {Loss::kData,
            "only " + percent(t.moved.measured_share()) + " of its silhouette has a measurement"};
  }
  if (f.from_truth.posed && !f.from_truth.right() && !told_apart(t.moved, contour, contour)) {
    const std::string away = "refined from the truth it goes to " +
                             fixed_digits(f.from_truth.error, 1) +
                             " limits away, where the depth fits ";
    const std::string advantage = " (the truth's advantage: " + percent(t.moved.advantage()) + ")";
    if (t.moved.advantage() < -kAdvantageMin)
      return {Loss::kTruth, away + "better than at the pose given as true" + advantage};
    return {Loss::kData, away + "as well" + advantage};
  }
  const bool compared = t.owner.silhouette_px > 0;
  if (f.has_owner && compared && f.owner_share > kCoveredShareMax &&
      !told_apart(t.owner, contour, f.owner.contour_support)) {
    return {Loss::kData,
            "the pose reported in its place fits the data as well (the truth's advantage: depth " +
                percent(t.owner.advantage()) + ", outline " +
                percent(contour - f.owner.contour_support) + ")"};
  }
  return {};
}

std::string search_text(const TargetFinding& t, int step, bool limited) {
  std::string depths;
  for (const double score : t.finding.template_scores) {
    if (score >= 0) depths += (depths.empty() ? "" : ", ") + fixed_digits(score, 2);
  }
  const std::string where = step == 0 ? "scan" : "descent " + std::to_string(step);
  return where + (limited ? ": found, but beyond the limits" : ": nothing near it goes on") +
         "; the nearest templates score " + (depths.empty() ? "nothing" : depths) +
         " of 2 at the truth, level by level";
}

std::string counted(const Sighting& before) {
  return before.passed()
             ? "number " + std::to_string(before.place + 1) + " of " + std::to_string(before.count)
             : "";
}

// By the checkpoint at which the last pose near the truth was lost.
LossCause lost_at(const TargetFinding& t, double threshold) {
  const auto& sightings = t.finding.sightings;
  int last = -1;
  for (int i = 0; i < kCheckpointCount; ++i) {
    if (sightings[static_cast<std::size_t>(i)].seen()) last = i;
  }
  int next = last + 1;
  while (next < kCheckpointCount && !sightings[static_cast<std::size_t>(next)].passed()) ++next;
  const Sighting before = last < 0 ? Sighting{} : sightings[static_cast<std::size_t>(last)];
  switch (static_cast<Checkpoint>(next)) {
    case Checkpoint::kScanned:
    case Checkpoint::kDescended1:
    case Checkpoint::kDescended2:
    case Checkpoint::kDescended3:
      return {Loss::kSearch, search_text(t, next / 2, false)};
    case Checkpoint::kScanSelected:
    case Checkpoint::kSelected1:
    case Checkpoint::kSelected2:
    case Checkpoint::kSelected3:
      return {Loss::kSearch, search_text(t, next / 2, true)};
    case Checkpoint::kScored:
      return {Loss::kRefinement, "scoring: moved along the ray to another surface, or to none"};
    case Checkpoint::kScoreSelected:
      return {Loss::kSuppression,
              "scoring: " + counted(before) + " of the leaves, beyond the limit"};
    case Checkpoint::kAlignedCoarse:
      return {Loss::kRefinement, "the coarse alignment (ICP, or PnP without depth) took it away"};
    case Checkpoint::kCoarseSelected:
      return {
          Loss::kSuppression,
          "after the coarse alignment: too many better ones at its place, or a far more probable "
          "one"};
    case Checkpoint::kAlignedFine:
      return {Loss::kRefinement, "the fine alignment took it away"};
    case Checkpoint::kFineSelected:
      return {Loss::kSuppression, "after the fine alignment: too many better ones at its place"};
    case Checkpoint::kAccepted:
      break;
    default:
      return {Loss::kVerification, "reported with a probability of " +
                                       fixed_digits(t.finding.last_score, 3) +
                                       ", below the threshold of " + fixed_digits(threshold, 2)};
  }
  const bool ranked = t.finding.last_drop == DropReason::kOverlapsBetter ||
                      t.finding.last_drop == DropReason::kResultLimit;
  return {ranked ? Loss::kRanking : Loss::kVerification,
          "explanation: " + drop_text(t.finding.last_drop) + ", probability " +
              fixed_digits(t.finding.last_score, 3)};
}

}  // namespace

const char* loss_name(Loss loss) {
  static constexpr const char* kNames[kLossCount] = {
      "found", "search", "suppression", "refinement", "verification", "ranking", "data", "truth"};
  return kNames[static_cast<std::size_t>(loss)];
}

LossCause cause_of(const TargetFinding& t, bool found, double threshold,
                   double threshold_from_truth) {
  if (found) return {Loss::kNone, ""};
  const OracleStart& start = t.finding.from_truth;
  if (LossCause hidden = what_data_hide(t); hidden.loss != Loss::kNone) return hidden;
  const LossCause trace = lost_at(t, threshold);
  const std::string also = "; in the run " + std::string(loss_name(trace.loss)) + ", " + trace.why;
  if (!start.right()) {
    return {Loss::kRefinement, "begun at the truth it goes " + fixed_digits(start.error, 1) +
                                   " limits away, though the data tell (the truth's advantage: " +
                                   percent(t.moved.advantage()) + ")" + also};
  }
  if (start.objected || start.detection.score < std::min(threshold, threshold_from_truth)) {
    return {Loss::kVerification,
            "even begun at the truth " +
                (start.objected ? drop_text(start.objection) : "below the threshold") +
                ": probability " + fixed_digits(start.detection.score, 3) + also};
  }
  if (start.outranked) {
    return {Loss::kRanking, "even begun at the truth " + percent(start.owned_by_better) +
                                " of its pixels belong to poses that explain more (rank " +
                                fixed_digits(start.rank, 0) + " against " +
                                fixed_digits(t.finding.owner_rank, 0) + ")" + also};
  }
  return trace;
}

}  // namespace binpick::app
