// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include <array>

#include "binpick/report/detection.hpp"

namespace binpick {

// One for each ScoreTerm, and the constant.
using ScoreWeights = std::array<double, kScoreTermCount + 1>;

inline constexpr ScoreWeights kScoreWeights = {
    2.1974,    // depth_support
    5.1145,    // contour_support
    1.3944,    // measured
    2.5511,    // supported_area
    -43.6650,  // contradicted
    -1.8059,   // hidden
    5.2414,    // outline_steps
    0.0000,    // outline_bare
    -0.3838,   // outline_offset
    3.1135,    // creases
    0.0000,    // template
    -2.2205,   // conflicts
    -22.1575,  // constant
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
