// A detection report as JSON: for scripts, and for whoever wonders where a candidate went.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "binpick/report/detection.hpp"

namespace binpick::app {

// A unit quaternion with w >= 0, in the order w, x, y, z.
std::array<double, 4> quaternion_wxyz(const Mat3& R);

// Detections (without any: the best rejected pose, and why) with pose (4x4 row-major, and
// quaternion with translation) and evidence, times of stages and levels, candidates of levels, what
// was dropped and why.
nlohmann::ordered_json to_json(const DetectionReport& report,
                               std::span<const std::string> model_names);

}  // namespace binpick::app
