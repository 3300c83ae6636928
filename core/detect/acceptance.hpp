// Which verified poses are reported, and as what.
#pragma once

#include <optional>
#include <span>

#include "binpick/model/object_model.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

// What a pose's own evidence says against reporting it; nothing where it is good.
std::optional<DropReason> objection_to(const Hypothesis& h, double min_score);

Detection detection_of(std::span<const ObjectModel> models, const Scene& scene,
                       const Hypothesis& h);

}  // namespace binpick
