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
    0.0000,    // outline_steps
    0.0000,    // outline_bare
    -0.7236,   // outline_offset
    0.6060,    // creases
    0.0000,    // template
    -2.2277,   // conflicts
    -7.3053,   // constant
};

inline constexpr ScoreWeights kScoreWeightsOfDepthAlone = {
    0.8807,    // depth_support
    1.4763,    // contour_support
    1.8536,    // measured
    2.5650,    // supported_area
    -7.2118,   // contradicted
    -1.5374,   // hidden
    4.8565,    // outline_steps
    0.0000,    // outline_bare
    0.0000,    // outline_offset
    0.0000,    // creases
    0.5223,    // template
    -2.3085,   // conflicts
    -21.3509,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfIntensityAlone = {
    0.0000,    // depth_support
    0.0000,    // contour_support
    0.0000,    // measured
    0.9763,    // supported_area
    0.0000,    // contradicted
    0.0000,    // hidden
    0.0000,    // outline_steps
    -11.4082,  // outline_bare
    -0.4796,   // outline_offset
    1.0702,    // creases
    1.4905,    // template
    -0.7912,   // conflicts
    -9.9053,   // constant
};

}  // namespace binpick
