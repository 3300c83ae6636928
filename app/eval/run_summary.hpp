// Stage times, candidates and drops averaged over the frames of one part: what the tables and the
// report show beside the scores.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "eval/score.hpp"

namespace binpick::app {

// Means per frame.
struct RunSummary {
  int frames = 0;
  TimeSummary time;
  std::array<double, kStageCount> stage_ms{};
  int level_count = 0;
  std::array<double, kTreeLevelsMax> level_ms{};
  std::array<double, kTreeLevelsMax> candidates{};
  std::array<double, kTreeLevelsMax> templates_evaluated{};
  std::array<double, kDropReasonCount> dropped{};
};

RunSummary summarize_runs(const EvalRun& run, const std::vector<drivers::FrameId>& frames);

// A line of the tables: a part of the single-kind scenes, or one kind of a mixed scene.
struct RunLine {
  std::string name;
  RunSummary summary;
};

// Of each part in the report; a mixed scene, whose frames are searched for all its kinds at once,
// gives one line. Frames without truth come last, as "no truth".
std::vector<RunLine> summarize_parts(const EvalRun& run, const ScoreReport& report);

// "obj 1", "scene 7, obj 1".
std::string part_name(const PartScore& part);

}  // namespace binpick::app
