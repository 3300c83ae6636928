// What may be expected of a trained part, from a trial on simulated piles that nothing was fitted
// to: figures for the model file, and sentences for people.
#pragma once

#include <string>
#include <vector>

#include "binpick/model/model_trials.hpp"
#include "eval/reliability.hpp"
#include "training/pile_trial.hpp"

namespace binpick::app {

// The same wrong turn of the part, seen in several poses.
struct Confusion {
  Vec3 axis;             // unit, in the part's coordinates
  double angle_deg = 0;  // > 0
  int count = 0;
};

struct VisibilityBand {
  double from = 0, to = 0;  // visible fraction
  int instances = 0, found = 0;
};

struct SelfTest {
  SelfTestRecord record;
  double threshold = 0;
  double f1 = 0;
  double position_error_mm = 0, angle_error_deg = 0;  // means over the axes of right poses
  std::vector<VisibilityBand> bands;
  Reliability reliability;            // of the score as a probability
  int wrong = 0;                      // poses above the threshold
  std::vector<Confusion> confusions;  // of those, turned in place; most frequent first
};

SelfTest judge(const PileTrial& trial, const PartGeometry& geometry, double threshold);

// One sentence each, most important first; none where nothing is amiss.
std::vector<std::string> advice(const SelfTest& test, const ObjectModel& model);

}  // namespace binpick::app
