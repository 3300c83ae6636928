// How the scores fall when frames get worse: the same search over disturbed frames, level by level,
// and curves over what a run tells without another one.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "eval/disturb.hpp"
#include "eval/evaluation.hpp"
#include "eval/score.hpp"
#include "eval/svg_chart.hpp"

namespace binpick::app {

// Ascending in badness; the first is the frame as it is, which the evaluation itself has searched.
const std::vector<double>& sweep_levels(Disturbance d);

// "noise,light": the disturbances named; "all" names all. Throws std::invalid_argument with the
// word that is none.
std::vector<Disturbance> parse_disturbances(const std::string& list);

struct SweepPoint {
  Disturbance what = Disturbance::kNoise;
  double level = 0;
  EvalRun run;
};

class Sweep {
 public:
  explicit Sweep(const std::vector<Disturbance>& what);

  // Searches the group's frames at each level but the first of each disturbance.
  void run_group(const drivers::BopDataset& dataset, const EvalPlan& plan, const CameraGroup& group,
                 const ModelSet& models, const EvalSettings& settings, WorkerPool& pool,
                 const EvalTalk& talk);
  const std::vector<SweepPoint>& points() const { return points_; }
  bool empty() const { return points_.empty(); }
  // Mean over the frames of what level 1 of the noise is, in mm at the frames' mean distance.
  double noise_mm() const { return frames_ > 0 ? noise_sum_mm_ / frames_ : 0; }

 private:
  std::vector<SweepPoint> points_;
  double noise_sum_mm_ = 0;
  int frames_ = 0;
};

// What a chart shows: a line for each part, and the means at the fixed threshold.
struct SweepCurves {
  std::string name;  // "noise", "visible", ...
  std::string x_axis;
  std::string y_axis;
  std::vector<Curve> parts;
  // F1, precision and recall at the fixed threshold, precision over the parts of which anything was
  // found there: it has no value where nothing was. May be empty.
  std::vector<Curve> means;
};

// Of each disturbance: F1 at the best threshold of each part. `undisturbed` gives the first level.
std::vector<SweepCurves> score_sweep(const Sweep& sweep, const ScoreReport& undisturbed,
                                     const std::map<int, PartGeometry>& geometry,
                                     const TruthByFrame& truth);

// F1 over the threshold.
SweepCurves threshold_curves(const ScoreReport& score);

// Share of the instances that are found, by how much of them is visible, in steps of a tenth; at
// the best threshold, those that need not be found included.
SweepCurves visibility_curves(const ScoreReport& score, const TruthByFrame& truth,
                              const std::vector<ResultRow>& rows);

}  // namespace binpick::app
