// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include <array>

#include "binpick/report/detection.hpp"

namespace binpick {

// One for each ScoreTerm, and the constant.
using ScoreWeights = std::array<double, kScoreTermCount + 1>;

inline constexpr ScoreWeights kScoreWeights = {
    2.1972,    // depth_support
    5.1139,    // contour_support
    1.3940,    // measured
    2.5530,    // supported_area
    -43.6692,  // contradicted
    -1.8062,   // hidden
    5.2426,    // outline_steps
    0.0000,    // outline_continued
    -0.3840,   // outline_offset
    3.1139,    // creases
    0.0000,    // template
    0.0000,    // weakest_side
    0.0000,    // stray_edges
    -2.2213,   // rivals
    -22.1729,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfDepthAlone = {
    0.8845,    // depth_support
    1.4775,    // contour_support
    1.8354,    // measured
    2.5723,    // supported_area
    -7.1900,   // contradicted
    -1.5416,   // hidden
    4.8548,    // outline_steps
    -0.1991,   // outline_continued
    0.0000,    // outline_offset
    0.0000,    // creases
    0.5223,    // template
    0.0000,    // weakest_side
    0.0000,    // stray_edges
    -2.3106,   // rivals
    -21.4049,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfIntensityAlone = {
    0.0000,    // depth_support
    0.0000,    // contour_support
    0.0000,    // measured
    0.9833,    // supported_area
    0.0000,    // contradicted
    0.0000,    // hidden
    0.0000,    // outline_steps
    -11.4054,  // outline_continued
    -0.4802,   // outline_offset
    1.0676,    // creases
    1.4978,    // template
    0.0000,    // weakest_side
    0.0000,    // stray_edges
    -0.7938,   // rivals
    -9.9619,   // constant
};

}  // namespace binpick
