#include "eval/run_summary.hpp"

#include <algorithm>
#include <set>

namespace binpick::app {

RunSummary summarize_runs(const EvalRun& run, const std::vector<drivers::FrameId>& frames) {
  RunSummary sum;
  std::vector<double> times_s;
  for (const drivers::FrameId& id : frames) {
    const auto it = run.frames.find(id);
    if (it == run.frames.end()) continue;
    const DetectionReport& r = it->second.report;
    ++sum.frames;
    times_s.push_back(it->second.time_s);
    sum.level_count = std::max(sum.level_count, std::min(r.level_count, kTreeLevelsMax));
    for (int i = 0; i < kStageCount; ++i) sum.stage_ms[i] += r.stage_ms[i];
    for (int i = 0; i < kTreeLevelsMax; ++i) {
      sum.level_ms[i] += r.level_ms[i];
      sum.candidates[i] += r.candidates[i];
      sum.templates_evaluated[i] += static_cast<double>(r.templates_evaluated[i]);
    }
    for (int i = 0; i < kDropReasonCount; ++i) sum.dropped[i] += r.dropped[i];
  }
  const double share = sum.frames > 0 ? 1.0 / sum.frames : 0.0;
  for (double& v : sum.stage_ms) v *= share;
  for (double& v : sum.level_ms) v *= share;
  for (double& v : sum.candidates) v *= share;
  for (double& v : sum.templates_evaluated) v *= share;
  for (double& v : sum.dropped) v *= share;
  sum.time = summarize_times(times_s);
  return sum;
}

std::vector<RunLine> summarize_parts(const EvalRun& run, const ScoreReport& report) {
  std::vector<RunLine> lines;
  std::set<drivers::FrameId> seen;
  const auto add = [&](const std::string& name, const std::vector<drivers::FrameId>& frames) {
    const RunSummary summary = summarize_runs(run, frames);
    if (summary.frames > 0) lines.push_back({name, summary});
    seen.insert(frames.begin(), frames.end());
  };
  for (const PartScore& p : report.parts) add(part_name(p), p.frames);
  std::set<int> scenes;
  for (const PartScore& p : report.mixed) {
    if (scenes.insert(*p.mixed_scene).second)
      add("scene " + std::to_string(*p.mixed_scene), p.frames);
  }
  std::vector<drivers::FrameId> rest;
  for (const auto& [id, frame] : run.frames) {
    if (!seen.contains(id)) rest.push_back(id);
  }
  if (!rest.empty()) add("no truth", rest);
  return lines;
}

std::string part_name(const PartScore& part) {
  const std::string name = "obj " + std::to_string(part.obj_id);
  return part.mixed_scene ? "scene " + std::to_string(*part.mixed_scene) + ", " + name : name;
}

}  // namespace binpick::app
