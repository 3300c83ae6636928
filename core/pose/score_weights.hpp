// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include "binpick/report/detection.hpp"

namespace binpick {

inline constexpr ScoreTerms kScoreWeights = {
    1.6328,    // depth_support
    4.0763,    // contour_support
    0.6749,    // measured
    1.3046,    // supported_area
    -52.9603,  // contradicted
    -3.2274,   // hidden
    4.4681,    // outline_steps
    -1.4043,   // outline_continued
    -0.2044,   // outline_offset
    1.5517,    // creases
    0.4573,    // template
};
inline constexpr double kScoreWeightOfOne = -12.6502;

}  // namespace binpick
