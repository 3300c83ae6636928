// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include <array>

#include "binpick/report/detection.hpp"

namespace binpick {

// One for each ScoreTerm, and the constant.
using ScoreWeights = std::array<double, kScoreTermCount + 1>;

inline constexpr ScoreWeights kScoreWeights = {
    3.1088,    // depth_support
    13.2553,   // contour_support
    1.7912,    // measured
    1.7419,    // supported_area
    -41.0611,  // contradicted
    -6.4151,   // hidden
    0.0000,    // outline_bare
    -0.7236,   // outline_offset
    0.6060,    // creases
    0.0000,    // template
    -2.2277,   // conflicts
    -7.3053,   // constant
};

inline constexpr ScoreWeights kScoreWeightsOfDepthAlone = {
    1.4830,    // depth_support
    3.1349,    // contour_support
    0.7704,    // measured
    2.6779,    // supported_area
    -14.6551,  // contradicted
    -4.0164,   // hidden
    0.0000,    // outline_bare
    0.0000,    // outline_offset
    0.0000,    // creases
    0.0000,    // template
    -2.5543,   // conflicts
    -15.1576,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfIntensityAlone = {
    0.0000,    // depth_support
    0.0000,    // contour_support
    0.0000,    // measured
    0.8918,    // supported_area
    0.0000,    // contradicted
    0.0000,    // hidden
    -7.8028,   // outline_bare
    -0.9476,   // outline_offset
    2.7724,    // creases
    1.2744,    // template
    -0.3881,   // conflicts
    -11.0130,  // constant
};

}  // namespace binpick
