// Which score to ask for, so that few picks are wrong, as far as frames without truth can tell.
#pragma once

#include <optional>
#include <span>

#include "eval/reliability.hpp"

namespace binpick::app {

struct ScoredPose {
  double score = 0;         // probability that the pose is right
  std::size_t track = 0;    // the part that it is of
  bool found_again = true;  // that part is found in at least half of the frames
};

// What is to be expected of the poses with a threshold's score and more.
struct WrongPicks {
  double threshold = 0;
  double by_score = 0;   // mean of 1 - score
  RightShare poses;      // right: found again
  RightShare parts;      // the same, each part taken once
  double share() const;  // the larger of the two shares of wrong poses
};

WrongPicks wrong_picks(std::span<const ScoredPose> poses, double threshold);

// The lowest threshold, in steps of 0.01, at which at most `share_max` of the picks are to be
// expected to be wrong; nothing where there is none.
std::optional<WrongPicks> suggest_threshold(std::span<const ScoredPose> poses, double share_max);

// How many parts have to be right, and none wrong, before the interval stays below `share_max`.
int parts_to_promise(double share_max);

}  // namespace binpick::app
