#include "eval/evaluation.hpp"

#include <algorithm>
#include <memory>

#include "clock.hpp"
#include "error_text.hpp"
#include "sized_detector.hpp"

namespace binpick::app {
namespace {

using drivers::FrameId;
using drivers::LoadedFrame;

// The largest ROI of the group's frames; the whole image as soon as one frame has none.
DetectorLimits limits_of(const EvalPlan& plan, const CameraGroup& group, const LoadedFrame& frame,
                         int max_results) {
  DetectorLimits limits;
  limits.image_width = frame.camera.width;
  limits.image_height = frame.camera.height;
  limits.results_max = max_results;
  for (const std::size_t i : group.frames) {
    const FrameId id = plan.frames[i].id;
    const Roi& roi = plan.scenes.at(id.scene_id).frames.at(id.im_id).roi;
    if (roi.whole_image()) {
      limits.roi_width = limits.roi_height = 0;
      return limits;
    }
    limits.roi_width = std::max(limits.roi_width, std::min(roi.width, limits.image_width));
    limits.roi_height = std::max(limits.roi_height, std::min(roi.height, limits.image_height));
  }
  return limits;
}

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
  std::map<std::pair<int, int>, std::unique_ptr<SizedDetector>> detectors;
  const auto fault = [&](const FrameId& id, const std::string& what) {
    run.faults.push_back("frame " + drivers::frame_name(id) + ": " + what);
    if (talk.note) talk.note(run.faults.back());
  };
  for (std::size_t k = 0; k < group.frames.size(); ++k) {
    const WantedFrame& wanted = plan.frames[group.frames[k]];
    if (talk.progress) {
      talk.progress("searching", static_cast<double>(k) / static_cast<double>(group.frames.size()));
    }
    LoadedFrame frame;
    try {
      frame = dataset.load_frame(plan.scenes.at(wanted.id.scene_id), wanted.id.im_id);
    } catch (const drivers::DatasetError& e) {
      fault(wanted.id, e.what());
      continue;
    }
    std::vector<int> indices;
    for (const int obj_id : wanted.objects) {
      if (const int index = models.index_of(obj_id); index >= 0) indices.push_back(index);
    }
    if (indices.empty()) {
      fault(wanted.id, "there is no model of anything in it");
      continue;
    }
    std::unique_ptr<SizedDetector>& sized = detectors[{frame.camera.width, frame.camera.height}];
    if (!sized) {
      const DetectorLimits limits = limits_of(plan, group, frame, settings.max_results);
      sized = std::make_unique<SizedDetector>(models.models(), limits, settings.params, pool);
    }
    DetectRequest request;
    request.model_indices = indices;
    request.max_results = settings.max_results;
    request.min_score = settings.min_score;

    const Frame view = frame.view();
    const std::int64_t begin_ns = monotonic_ns();
    const Result<DetectionReport> report = sized->detector().detect(view, request);
    const double time_s = static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
    if (report.ok()) {
      keep_report(report.value(), wanted, models, time_s, output, run);
    } else {
      fault(wanted.id, error_text(report.error()));
    }
  }
  if (talk.progress && !group.frames.empty()) talk.progress("searching", 1.0);
}

}  // namespace binpick::app
