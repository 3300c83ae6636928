// Scores detections against the truth by the rules of the bin-picking experiment.
//
// A detection is right when each of the six pose parameters is within the limits, for the best of
// the part's symmetric poses. Instances that are visible enough (and whose origin is inside the
// ROI) have to be found; a detection that fits another instance counts neither for nor against.
// Detections choose in the order of their scores and each instance is taken once, so a duplicate is
// wrong. F1 is the best over a score threshold common to all frames of the part, equal scores
// staying together. Scenes with several kinds of part are scored apart ("mixed") and stay out of
// the mean.
#pragma once

#include <array>
#include <optional>

#include "eval/bop_results.hpp"
#include "eval/part_geometry.hpp"
#include "eval/score_truth.hpp"

namespace binpick::app {

struct ScoreOptions {
  PoseLimits limits;
  double visible_min = 0.7;
  std::optional<double> fixed_threshold;
  std::set<int> objects;  // empty: all
};

enum class Verdict { kRight, kWrong, kNeutral };

struct ThresholdScore {
  double f1 = 0, recall = 0, precision = 0;
  std::optional<double> threshold;  // none where no detection is right
  int judged = 0;                   // detections right or wrong; of none the precision says nothing
};

struct CurvePoint {
  double threshold, recall, precision;
};

// What became of one row of the results.
struct DetectionMark {
  std::size_t row_index = 0;
  Verdict verdict = Verdict::kWrong;
  int instance = -1;  // index into the frame's instances
};

struct TimeSummary {
  int count = 0;
  double mean_s = 0, p50_s = 0, p99_s = 0, max_s = 0;
};

struct AddScore {
  double f1 = 0, recall = 0;
};

struct PartScore {
  int obj_id = 0;
  std::optional<int> mixed_scene;
  std::vector<drivers::FrameId> frames;
  int instances = 0, detections = 0;
  ThresholdScore best;
  std::optional<ThresholdScore> fixed;
  std::optional<PoseError6> mean_abs_error;  // of the right ones at the best threshold
  TimeSummary time;
  AddScore add10, add15;  // ADD (ADD-S for symmetric parts) below 0.10, 0.15 of the diameter
  double mssd_recall = 0;
  std::vector<CurvePoint> curve;  // descending threshold
  std::vector<DetectionMark> marks;
};

struct MeanScore {
  ThresholdScore best;
  std::optional<double> fixed_f1;
  std::optional<PoseError6> mean_abs_error;
  std::optional<TimeSummary> time;  // max_s is the largest of all, the rest are means
  AddScore add10, add15;
  double mssd_recall = 0;
};

struct ScoreReport {
  ScoreOptions options;
  std::vector<PartScore> parts, mixed;
  std::optional<MeanScore> mean, mixed_mean;
};

// Throws DatasetError when an object of the truth has no geometry.
ScoreReport score_results(const std::map<int, PartGeometry>& geometry, const TruthByFrame& truth,
                          const std::vector<ResultRow>& rows,
                          const std::map<drivers::FrameId, double>& time_s,
                          const ScoreOptions& options);

// Whether the instance has to be found.
bool is_target(const ScoredInstance& instance, const ScoreOptions& options);

// Of none, nothing. Each value is averaged over the parts that have it.
std::optional<MeanScore> mean_of(const std::vector<PartScore>& parts);

// Percentiles interpolate linearly between order statistics.
TimeSummary summarize_times(std::vector<double> seconds);

}  // namespace binpick::app
