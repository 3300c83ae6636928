#include "eval/eval_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "eval/score_json.hpp"
#include "frame_findings.hpp"

namespace binpick::app {
namespace {

using nlohmann::json;

json frame_to_json(const drivers::FrameId& id, const FrameRun& frame) {
  const DetectionReport& r = frame.report;
  json stages, levels = json::array(), dropped;
  for (int i = 0; i < kStageCount; ++i) stages[stage_name(static_cast<Stage>(i))] = r.stage_ms[i];
  for (int d = 0; d < std::min(r.level_count, kTreeLevelsMax); ++d) {
    levels.push_back({{"ms", r.level_ms[d]},
                      {"templates_evaluated", r.templates_evaluated[d]},
                      {"candidates", r.candidates[d]}});
  }
  for (int i = 0; i < kDropReasonCount; ++i)
    dropped[drop_reason_name(static_cast<DropReason>(i))] = r.dropped[i];
  json diagnostics = json::array();
  for (const Finding& finding : frame.findings.found())
    diagnostics.push_back(finding_name(finding.code));
  return {
      {"diagnostics", diagnostics}, {"scene_id", id.scene_id}, {"im_id", id.im_id},
      {"obj_ids", frame.objects},   {"time", frame.time_s},    {"stage_ms", stages},
      {"levels", levels},           {"dropped", dropped},      {"detections", frame.detections}};
}

}  // namespace

json eval_to_json(const ScoreReport& score, const EvalRun& run,
                  const std::vector<ModelOrigin>& models,
                  const std::vector<std::pair<std::string, std::string>>& facts) {
  json out = score_to_json(score);
  for (const auto& [name, value] : facts) out["run"][name] = value;
  out["models"] = json::array();
  for (const ModelOrigin& m : models) {
    out["models"].push_back({{"obj_id", m.obj_id},
                             {"distance_mm", {m.range.min_mm, m.range.max_mm}},
                             {"bytes", m.bytes},
                             {"from_cache", m.from_cache},
                             {"train_s", m.train_s}});
  }
  out["frames"] = json::array();
  for (const auto& [id, frame] : run.frames) out["frames"].push_back(frame_to_json(id, frame));
  out["faults"] = run.faults;
  return out;
}

}  // namespace binpick::app
