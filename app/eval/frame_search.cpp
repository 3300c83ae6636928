#include "eval/frame_search.hpp"

#include <algorithm>
#include <memory>

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

}  // namespace

PartName object_name(const ModelSet& models) {
  return [&models](int model) {
    return "object " + std::to_string(models.origins()[static_cast<std::size_t>(model)].obj_id);
  };
}

void visit_frames(const drivers::BopDataset& dataset, const EvalPlan& plan,
                  const CameraGroup& group, const ModelSet& models, const SearchSettings& settings,
                  WorkerPool& pool, const EvalTalk& talk, const std::string& doing,
                  std::vector<std::string>& faults,
                  const std::function<Result<int>(const FrameVisit&)>& visit) {
  std::map<std::pair<int, int>, std::unique_ptr<SizedDetector>> detectors;
  const auto fault = [&](const FrameId& id, const std::string& what) {
    faults.push_back("frame " + drivers::frame_name(id) + ": " + what);
    if (talk.note) talk.note(faults.back());
  };
  for (std::size_t k = 0; k < group.frames.size(); ++k) {
    const WantedFrame& wanted = plan.frames[group.frames[k]];
    if (talk.progress)
      talk.progress(doing, static_cast<double>(k) / static_cast<double>(group.frames.size()));
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
    const FrameFindings findings =
        indices.empty() ? check_frame(frame.view(), {{}, {}, settings.modality})
                        : check_frame(frame.view(), {models.models(), indices, settings.modality});
    if (const Finding* refusal = findings.refusal()) {
      fault(wanted.id, finding_text(*refusal, object_name(models)));
      continue;
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
    request.modality = settings.modality;
    request.max_results = settings.max_results;
    request.min_score = settings.min_score;
    const Result<int> visited = visit({wanted, frame, sized->detector(), request, findings});
    if (!visited.ok()) fault(wanted.id, error_text(visited.error()));
  }
  if (talk.progress && !group.frames.empty()) talk.progress(doing, 1.0);
}

}  // namespace binpick::app
