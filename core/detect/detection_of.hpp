// What a hypothesis that survived is reported as.
#pragma once

#include <span>

#include "binpick/model/object_model.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

Detection detection_of(std::span<const ObjectModel> models, const Scene& scene,
                       const Hypothesis& h);

}  // namespace binpick
