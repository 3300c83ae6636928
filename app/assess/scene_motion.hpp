// How the scene moved as a whole between two frames, from the poses found in them alone.
#pragma once

#include <span>

#include "assess/observation.hpp"
#include "assess/same_pose.hpp"

namespace binpick::app {

struct SceneMotion {
  Pose motion;             // from the camera axes of the first frame to those of the second
  int agreeing = 0;        // poses of the first frame that it takes onto one of the second
  int compared = 0;        // of these poses
  double score_share = 0;  // of the sum of their scores: what agrees
  int next_best = 0;       // how many agree with the best motion that is another one
  double shift_mm = 0;     // of the middle of the poses that agree
  double angle_rad = 0;

  // Enough poses agree, and with no other motion nearly as many.
  bool determined() const {
    return agreeing >= kAgreeingMin && score_share >= kScoreShareMin && agreeing >= 2 * next_best;
  }
  static constexpr int kAgreeingMin = 3;
  static constexpr double kScoreShareMin = 0.3;  // in crowded bins a few agree by chance
};

// Compares the most probable poses of both frames. `parts` has an entry for each model. A part that
// looks the same from everywhere (a ball) gives no motion, but may agree with one.
SceneMotion find_motion(std::span<const Observation> from, std::span<const Observation> to,
                        std::span<const SamePose> parts);

}  // namespace binpick::app
