// From matched templates to hypotheses that are worth refining. A template says roughly how a part
// stands; measured depth says how far away, and whether a surface like the part's is there at all.
#pragma once

#include <span>

#include "pose/hypothesis.hpp"

namespace binpick {

// Turns each leaf candidate into a pose, moves it along its ray onto the measured surface, and
// ranks it by template score times the share of its surface that the measurement then supports. Of
// poses closer to each other than the leaves' spacing the best stays (non-maximum suppression in
// 6D). `scratch` has room for all candidates. Returns how many were written to `out`, best first;
// those that find no surface, repeat a better one or find no room are counted in the report.
int screen_candidates(const PoseContext& context, std::span<const Candidate> leaves,
                      const FeaturePyramid& pyramid, std::span<Hypothesis> scratch,
                      std::span<Hypothesis> out, DetectionReport& report);

}  // namespace binpick
