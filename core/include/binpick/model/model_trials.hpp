// What trying a trained model on simulated piles told: how its score is to be read, and what may be
// expected of it. Kept in the model file as it stands here, little-endian. As it is
// initialized here where the model was not tried.
#pragma once

#include <cstdint>

namespace binpick {

// Of this part: log odds that a pose is right = slope * (log odds by the evidence) + offset.
struct ScoreCalibration {
  double slope = 1;
  double offset = 0;
};

// Found and right among the parts that are mostly visible, at the default threshold of the score;
// on piles that nothing was fitted to.
struct SelfTestRecord {
  std::int32_t piles = 0;
  std::int32_t instances = 0;  // mostly visible ones
  double recall = 0;
  double precision = 0;
  double visible_fraction_min = 0;  // of parts this visible, half are found
};

struct ModelTrials {
  ScoreCalibration with_intensity, depth_alone;
  std::int32_t calibration_piles = 0;  // 0: not calibrated
  std::int32_t reserved = 0;
  // What the covariance of a pose, reckoned as if all measurements erred on their own, has to be
  // multiplied by to be that of the errors seen.
  double variance_scale = 4;
  SelfTestRecord self_test;
};

}  // namespace binpick
