#include "eval/fault_analysis.hpp"

#include <algorithm>
#include <set>

#include "eval/assignment.hpp"
#include "eval/run_summary.hpp"

namespace binpick::app {
namespace {

using Instance = std::pair<drivers::FrameId, int>;
using PartTargets = std::vector<const TargetFinding*>;

PartTargets targets_of(const PartScore& part, const std::vector<TargetFinding>& targets) {
  const std::set<drivers::FrameId> frames(part.frames.begin(), part.frames.end());
  PartTargets own;
  for (const TargetFinding& t : targets) {
    if (t.obj_id == part.obj_id && frames.contains(t.frame)) own.push_back(&t);
  }
  return own;
}

// Whether a pose of `start` takes the place of this detection.
bool displaced(const ResultRow& row, const PartTargets& targets,
               OracleStart ReferenceFinding::*start) {
  return std::any_of(targets.begin(), targets.end(), [&](const TargetFinding* t) {
    const ReferenceFinding& f = t->finding;
    return t->frame == row.frame && f.has_owner && f.owner_share > kCoveredShareMax &&
           (f.*start).right() && (f.*start).reported() &&
           f.owner.T_cam_obj.t_mm == row.T_cam_obj.t_mm && f.owner.T_cam_obj.R == row.T_cam_obj.R;
  });
}

// The best F1, were every part begun at `start`.
ThresholdScore reachable(const PartScore& part, const std::vector<ResultRow>& rows,
                         const PartTargets& targets, OracleStart ReferenceFinding::*start) {
  std::vector<Scored> scored;
  for (const TargetFinding* t : targets) {
    const OracleStart& s = t->finding.*start;
    if (!s.reported()) continue;
    scored.push_back({s.detection.score, s.right() ? Verdict::kRight : Verdict::kWrong});
  }
  for (const DetectionMark& mark : part.marks) {
    const ResultRow& row = rows[mark.row_index];
    if (mark.verdict == Verdict::kWrong && !displaced(row, targets, start))
      scored.push_back({row.score, Verdict::kWrong});
  }
  return best_over_thresholds(scored, part.instances, nullptr);
}

PartFaults faults_of(const PartScore& part, const PartGeometry& geometry, const TruthByFrame& truth,
                     const std::vector<ResultRow>& rows, const ScoreOptions& options,
                     const std::vector<TargetFinding>& all_targets) {
  const PartTargets targets = targets_of(part, all_targets);
  PartFaults out;
  out.name = part_name(part);
  out.obj_id = part.obj_id;
  // Without any right detection there is no best threshold: everything reported counts.
  out.threshold = part.best.threshold.value_or(0);
  std::set<Instance> found;
  for (const DetectionMark& mark : part.marks) {
    const ResultRow& row = rows[mark.row_index];
    if (row.score < out.threshold) continue;
    if (mark.verdict == Verdict::kRight) found.insert({row.frame, mark.instance});
    if (mark.verdict != Verdict::kWrong) continue;
    FalsePick pick = classify_false_pick(geometry, part.obj_id, row.T_cam_obj, truth.at(row.frame),
                                         options.limits);
    pick.row_index = mark.row_index;
    ++out.false_picks[static_cast<std::size_t>(pick.kind)];
    out.wrong.push_back(pick);
  }
  out.run = part.best;
  out.from_truth = reachable(part, rows, targets, &ReferenceFinding::from_truth);
  out.from_template = reachable(part, rows, targets, &ReferenceFinding::from_template);
  for (const TargetFinding* t : targets) {
    const bool is_found = found.contains({t->frame, t->instance});
    ++out.targets;
    out.found += is_found;
    const LossCause cause =
        cause_of(*t, is_found, out.threshold, out.from_truth.threshold.value_or(out.threshold));
    ++out.lost[static_cast<std::size_t>(cause.loss)];
    if (is_found) continue;
    const auto& instance = truth.at(t->frame)[static_cast<std::size_t>(t->instance)];
    out.missed.push_back({t, cause, instance.truth.visible_fraction});
  }
  return out;
}

}  // namespace

std::vector<PartFaults> analyse_faults(const ScoreReport& score, const TruthByFrame& truth,
                                       const std::map<int, PartGeometry>& geometry,
                                       const std::vector<ResultRow>& rows,
                                       const std::vector<TargetFinding>& targets) {
  std::vector<PartFaults> all;
  for (const auto* parts : {&score.parts, &score.mixed}) {
    for (const PartScore& part : *parts)
      all.push_back(faults_of(part, geometry.at(part.obj_id), truth, rows, score.options, targets));
  }
  return all;
}

}  // namespace binpick::app
