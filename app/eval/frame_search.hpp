// Visits the frames of a camera group, each with a detector made for its size.
#pragma once

#include <functional>

#include "binpick/check/frame_check.hpp"
#include "binpick/detect/detector.hpp"
#include "eval/eval_plan.hpp"
#include "eval/model_set.hpp"
#include "frame_findings.hpp"

namespace binpick::app {

struct SearchSettings {
  DetectorParams params;
  Modality modality = Modality::kAutomatic;  // the detector does not see the other image
  int max_results = 64;
  double min_score = 0.01;  // low on purpose: the score's threshold is chosen afterwards
};

// One frame in memory, and what is wanted of it.
struct FrameVisit {
  const WantedFrame& wanted;
  drivers::LoadedFrame& frame;
  Detector& detector;
  const DetectRequest& request;
  const FrameFindings& findings;
};

// What findings call the set's models, which outlive it.
PartName object_name(const ModelSet& models);

// A frame that cannot be read, that can only be a mistake, or of whose objects there is no model,
// is a fault, noted and added to `faults`; an error that `visit` returns is another.
void visit_frames(const drivers::BopDataset& dataset, const EvalPlan& plan,
                  const CameraGroup& group, const ModelSet& models, const SearchSettings& settings,
                  WorkerPool& pool, const EvalTalk& talk, const std::string& doing,
                  std::vector<std::string>& faults,
                  const std::function<Result<int>(const FrameVisit&)>& visit);

}  // namespace binpick::app
