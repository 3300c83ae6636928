// Detections to picks: in the order in which the robot should take them, in the frame that it
// thinks in. Pure; the cycle's thread.
#pragma once

#include <span>

#include "station/cycle_result.hpp"
#include "station/recipe_set.hpp"

namespace binpick::app {

// Writes the best min(limit, picks.size()) and returns how many. `T_ref_cam` maps camera
// coordinates into the frame that is published; with high_base its z axis points up. Equals are
// ordered by score, then by position, so that the order never depends on chance.
int rank_picks(std::span<const Detection> detections, const Recipe& recipe, Ranking ranking,
               const Pose& T_ref_cam, bool in_base, int limit, std::span<int> order,
               std::span<Pick> picks);

}  // namespace binpick::app
