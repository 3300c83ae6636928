// Written by tools/calibration/fit_score.py; not by hand.
#pragma once

#include <array>

#include "binpick/report/detection.hpp"

namespace binpick {

// One for each ScoreTerm, and the constant.
using ScoreWeights = std::array<double, kScoreTermCount + 1>;

inline constexpr ScoreWeights kScoreWeights = {
    1.3973,    // depth_support
    4.6197,    // contour_support
    0.8078,    // measured
    1.3975,    // supported_area
    -59.8846,  // contradicted
    -3.4230,   // hidden
    4.3581,    // outline_steps
    -1.5776,   // outline_continued
    -0.1882,   // outline_offset
    1.9571,    // creases
    0.3900,    // template
    0.0000,    // weakest_side
    0.0000,    // stray_edges
    -1.0000,   // rivals
    -13.4234,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfDepthAlone = {
    0.0000,    // depth_support
    0.9317,    // contour_support
    2.2909,    // measured
    2.1448,    // supported_area
    -13.5119,  // contradicted
    -1.5978,   // hidden
    4.3581,    // outline_steps
    -1.2809,   // outline_continued
    0.0000,    // outline_offset
    0.0000,    // creases
    2.3745,    // template
    0.0000,    // weakest_side
    0.0000,    // stray_edges
    -1.0000,   // rivals
    -21.9572,  // constant
};

inline constexpr ScoreWeights kScoreWeightsOfIntensityAlone = {
    0.0000,    // depth_support
    0.5069,    // contour_support
    0.0000,    // measured
    2.2976,    // supported_area
    0.0000,    // contradicted
    0.0000,    // hidden
    0.0000,    // outline_steps
    -5.1900,   // outline_continued
    -1.4245,   // outline_offset
    2.5145,    // creases
    0.0000,    // template
    0.9675,    // weakest_side
    -0.3439,   // stray_edges
    -1.0000,   // rivals
    -19.9889,  // constant
};

}  // namespace binpick
