// Runs the detector over the frames of a plan and keeps what each run reported.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "eval/bop_results.hpp"
#include "eval/eval_plan.hpp"
#include "eval/evidence_csv.hpp"
#include "eval/model_set.hpp"

namespace binpick::app {

// The account of one detect() call.
struct FrameRun {
  std::set<int> objects;
  double time_s = 0;  // from the frame in memory to the poses
  std::size_t detections = 0;
  DetectionReport report;  // without the detections, which the detector takes back
};

struct EvalRun {
  std::vector<ResultRow> rows;
  std::map<drivers::FrameId, FrameRun> frames;
  std::vector<std::string> faults;  // frames that could not be read or searched: a sentence each

  std::map<drivers::FrameId, double> times_s() const;
};

struct EvalSettings {
  DetectorParams params;
  int max_results = 64;
  double min_score = 0.01;  // low on purpose: the score's threshold is chosen afterwards
};

// Files that detections go to as they are found; either may be null.
struct EvalOutput {
  BopResultsWriter* results = nullptr;
  EvidenceWriter* evidence = nullptr;
};

// The frames of one camera group, in the order of the plan. What goes wrong
// with a frame is noted, and the next one follows.
void run_group(const drivers::BopDataset& dataset, const EvalPlan& plan, const CameraGroup& group,
               const ModelSet& models, const EvalSettings& settings, WorkerPool& pool,
               const EvalTalk& talk, const EvalOutput& output, EvalRun& run);

}  // namespace binpick::app
