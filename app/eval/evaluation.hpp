// Runs the detector over the frames of a plan and keeps what each run reported.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "eval/bop_results.hpp"
#include "eval/evidence_csv.hpp"
#include "eval/frame_search.hpp"

namespace binpick::app {

// The account of one detect() call.
struct FrameRun {
  std::set<int> objects;
  FrameFindings findings;
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
  SearchSettings search;
  // Changes a frame before it is searched, as a worse sensor would; may be empty.
  std::function<void(const drivers::FrameId&, drivers::LoadedFrame&)> disturb;
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
