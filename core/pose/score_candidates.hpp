// From matched templates to hypotheses that are worth aligning. A template says roughly how a part
// stands; measured depth says how far away, and whether a surface like the part's is there at all.
#pragma once

#include <span>

#include "pose/hypothesis.hpp"

namespace binpick {

// Turns each leaf candidate into a pose, moves it along its ray onto the measured surface, and
// ranks it by template score times the share of its surface that the measurement then supports.
// Without depth the distance is the template's, and the rank the share of its contour on edges of
// its direction, beyond chance. Drops what finds no surface. `out` has the size of `leaves`.
void score_candidates(const PoseContext& context, std::span<const Candidate> leaves,
                      const FeaturePyramid& pyramid, std::span<Hypothesis> out);

}  // namespace binpick
