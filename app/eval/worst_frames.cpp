#include "eval/worst_frames.hpp"

#include <algorithm>
#include <limits>

namespace binpick::app {
namespace {

bool worse(const FrameOutcome& a, const FrameOutcome& b) {
  return a.wrong + a.missed > b.wrong + b.missed;
}

OverlayStyle style_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight:
      return OverlayStyle::kRight;
    case Verdict::kWrong:
      return OverlayStyle::kFalsePick;
    case Verdict::kNeutral:
      return OverlayStyle::kNeutral;
  }
  return OverlayStyle::kNeutral;
}

}  // namespace

std::vector<FrameOutcome> frame_outcomes(const PartScore& part, const TruthByFrame& truth,
                                         const std::vector<ResultRow>& rows,
                                         const ScoreOptions& options) {
  std::map<drivers::FrameId, FrameOutcome> outcomes;
  for (const drivers::FrameId& id : part.frames) outcomes[id].frame = id;
  std::map<drivers::FrameId, std::set<int>> found;
  // Without any right detection there is no best threshold: show them all.
  const double threshold = part.best.threshold.value_or(std::numeric_limits<double>::lowest());
  for (const DetectionMark& mark : part.marks) {
    const ResultRow& row = rows[mark.row_index];
    if (row.score < threshold) continue;
    FrameOutcome& outcome = outcomes[row.frame];
    outcome.marks.push_back(mark);
    outcome.right += mark.verdict == Verdict::kRight;
    outcome.wrong += mark.verdict == Verdict::kWrong;
    if (mark.instance >= 0) found[row.frame].insert(mark.instance);
  }
  std::vector<FrameOutcome> list;
  for (auto& [id, outcome] : outcomes) {
    outcome.part = &part;
    const std::vector<ScoredInstance>& instances = truth.at(id);
    for (std::size_t i = 0; i < instances.size(); ++i) {
      if (instances[i].truth.obj_id != part.obj_id || !is_target(instances[i], options)) continue;
      if (found[id].contains(static_cast<int>(i))) continue;
      outcome.missed_instances.push_back(static_cast<int>(i));
      ++outcome.missed;
    }
    list.push_back(std::move(outcome));
  }
  return list;
}

std::vector<FrameOutcome> worst_frames(const ScoreReport& report, const TruthByFrame& truth,
                                       const std::vector<ResultRow>& rows, std::size_t count_max) {
  std::vector<FrameOutcome> first, rest;
  for (const auto* parts : {&report.parts, &report.mixed}) {
    for (const PartScore& part : *parts) {
      std::vector<FrameOutcome> outcomes = frame_outcomes(part, truth, rows, report.options);
      std::erase_if(outcomes, [](const FrameOutcome& o) { return o.wrong + o.missed == 0; });
      std::stable_sort(outcomes.begin(), outcomes.end(), worse);
      for (std::size_t i = 0; i < outcomes.size(); ++i)
        (i == 0 ? first : rest).push_back(std::move(outcomes[i]));
    }
  }
  std::stable_sort(rest.begin(), rest.end(), worse);
  for (FrameOutcome& o : rest) first.push_back(std::move(o));
  if (first.size() > count_max) first.resize(count_max);
  return first;
}

std::vector<OverlayItem> overlay_items(const FrameOutcome& outcome, const TruthByFrame& truth,
                                       const std::vector<ResultRow>& rows,
                                       const train::Mesh& mesh) {
  std::vector<OverlayItem> items;
  for (const DetectionMark& mark : outcome.marks) {
    const ResultRow& row = rows[mark.row_index];
    items.push_back({row.T_cam_obj, &mesh, row.score, "", style_of(mark.verdict)});
  }
  for (const int i : outcome.missed_instances) {
    const Pose& pose = truth.at(outcome.frame)[static_cast<std::size_t>(i)].truth.T_cam_obj;
    items.push_back({pose, &mesh, std::nullopt, "missed", OverlayStyle::kMiss});
  }
  const auto order = [](const OverlayItem& item) {
    switch (item.style) {
      case OverlayStyle::kFalsePick:
        return 0;
      case OverlayStyle::kMiss:
        return 1;
      default:
        return 2;
    }
  };
  std::stable_sort(
      items.begin(), items.end(),
      [&order](const OverlayItem& a, const OverlayItem& b) { return order(a) < order(b); });
  return items;
}

std::string caption(const FrameOutcome& o) {
  return "scene " + std::to_string(o.frame.scene_id) + ", image " + std::to_string(o.frame.im_id) +
         ", obj " + std::to_string(o.part->obj_id) + ": " + std::to_string(o.right) + " right, " +
         std::to_string(o.wrong) + (o.wrong == 1 ? " false pick, " : " false picks, ") +
         std::to_string(o.missed) + " missed";
}

}  // namespace binpick::app
