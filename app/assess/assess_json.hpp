// An assessment as JSON, for scripts. Lengths in mm, angles in degrees.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "assess/assessment.hpp"

namespace binpick::app {

nlohmann::ordered_json assessment_json(const Assessment& assessment);

}  // namespace binpick::app
