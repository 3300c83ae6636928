// One pose found in one frame, as an assessment keeps it.
#pragma once

#include "binpick/geometry/pose.hpp"
#include "binpick/report/detection.hpp"

namespace binpick::app {

struct Observation {
  int frame = 0;  // index of the frame in the assessment
  int model = 0;
  double score = 0;
  // Of the middle of the part's bounding box, which the covariance is about too; in the camera axes
  // of the reference frame once the motion of the scene is taken out.
  Pose T_cam_centre;
  Mat6 covariance = Mat6::Zero();  // of a rotation vector (rad), then of a shift (mm)
  ScoreTerms terms{};
  double residual_mm = 0;
  double missing_share = 0;  // of the visible surface: without depth
};

}  // namespace binpick::app
