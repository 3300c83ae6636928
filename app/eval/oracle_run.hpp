// Looks at each part that has to be found: where the detector loses it, and what it makes of it
// when it need not search. The truth goes into the diagnosis only; the detections of an evaluation
// come from a run that knows none.
#pragma once

#include <vector>

#include "binpick/diagnosis/diagnosis.hpp"
#include "eval/frame_search.hpp"
#include "eval/score.hpp"
#include "eval/tell_apart.hpp"

namespace binpick::app {

// One target, and what the diagnosis found.
struct TargetFinding {
  drivers::FrameId frame;
  int obj_id = 0;
  int instance = 0;  // index into the frame's truth
  ReferenceFinding finding;
  // The truth as refinement leaves it, or as given where that is no longer right, against:
  PoseComparison moved;  // where refinement took the truth
  PoseComparison owner;  // another pose of this part that was accepted; empty where there is none
};

struct OracleRequest {
  const drivers::BopDataset& dataset;
  const EvalPlan& plan;
  const PartLibrary& parts;
  const std::map<int, PartGeometry>& geometry;
  ScoreOptions options;
  SearchSettings search;
};

// Appends the targets of the group's frames. Throws RenderError.
void run_oracle(const OracleRequest& request, const CameraGroup& group, const ModelSet& models,
                WorkerPool& pool, const EvalTalk& talk, std::vector<TargetFinding>& found,
                std::vector<std::string>& faults);

}  // namespace binpick::app
