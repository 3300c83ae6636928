// What a hypothesis that survived is reported as.
#pragma once

#include "pose/hypothesis.hpp"

namespace binpick {

Detection detection_of(const PoseContext& context, const Hypothesis& h);

}  // namespace binpick
