// What trying a trained model on simulated piles told: how its score is to be read, and what may be
// expected of it. Kept in the model file as it stands here, little-endian. As it is
// initialized here where the model was not tried.
#pragma once

#include <cstdint>

#include "binpick/frame/modality.hpp"

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
  ScoreCalibration with_intensity, depth_alone, intensity_alone;
  std::int32_t calibration_piles = 0;  // 0: not calibrated
  std::int32_t reserved = 0;
  // What the covariance of a pose, reckoned as if all measurements erred on their own, has to be
  // multiplied by to be that of the errors seen; poses from intensity alone have their own.
  double variance_scale = 4;
  double variance_scale_intensity_alone = 12;
  SelfTestRecord self_test;

  const ScoreCalibration& calibration_of(Modality seen) const {
    if (seen == Modality::kIntensity) return intensity_alone;
    return seen == Modality::kDepth ? depth_alone : with_intensity;
  }
  double variance_scale_of(Modality seen) const {
    return seen == Modality::kIntensity ? variance_scale_intensity_alone : variance_scale;
  }
};

}  // namespace binpick
