#include "eval/evaluation.hpp"

#include "clock.hpp"

namespace binpick::app {
namespace {

using drivers::FrameId;

void keep_report(const DetectionReport& report, const WantedFrame& wanted, const ModelSet& models,
                 double time_s, const EvalOutput& output, EvalRun& run) {
  for (const Detection& d : report.detections) {
    const int obj_id = models.origins()[static_cast<std::size_t>(d.model_index)].obj_id;
    const ResultRow row{wanted.id, obj_id, d.score, d.T_cam_obj, time_s};
    if (output.results != nullptr) output.results->add(row);
    if (output.evidence != nullptr) output.evidence->add(row, d.score_terms);
    run.rows.push_back(row);
  }
  FrameRun& frame = run.frames[wanted.id];
  frame.objects = wanted.objects;
  frame.time_s = time_s;
  frame.detections = report.detections.size();
  frame.report = report;
  frame.report.detections = {};
}

}  // namespace

std::map<FrameId, double> EvalRun::times_s() const {
  std::map<FrameId, double> times;
  for (const auto& [id, frame] : frames) times[id] = frame.time_s;
  return times;
}

void run_group(const drivers::BopDataset& dataset, const EvalPlan& plan, const CameraGroup& group,
               const ModelSet& models, const EvalSettings& settings, WorkerPool& pool,
               const EvalTalk& talk, const EvalOutput& output, EvalRun& run) {
  FindingsTold told;
  const auto search = [&](const FrameVisit& visit) -> Result<int> {
    for (const std::string& sentence : told.fresh(visit.findings, object_name(models))) {
      if (talk.note && !settings.disturb)
        talk.note("frame " + drivers::frame_name(visit.wanted.id) + ": " + sentence);
    }
    if (settings.disturb) settings.disturb(visit.wanted.id, visit.frame);
    const Frame view = visit.frame.view();
    const std::int64_t begin_ns = monotonic_ns();
    const Result<DetectionReport> report = visit.detector.detect(view, visit.request);
    const double time_s = static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
    if (!report.ok()) return report.error();
    keep_report(report.value(), visit.wanted, models, time_s, output, run);
    run.frames[visit.wanted.id].findings = visit.findings;
    return 0;
  };
  visit_frames(dataset, plan, group, models, settings.search, pool, talk, "searching", run.faults,
               search);
}

}  // namespace binpick::app
