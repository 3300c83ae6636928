// The symmetries in a model file, for people and for scripts. Points are in CAD coordinates.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "binpick/model/object_model.hpp"

namespace binpick::app {

// An axis about which the part looks the same `fold` times in a turn.
struct FoldAxis {
  Vec3 axis, point_mm;
  int fold = 2;
};

std::vector<FoldAxis> fold_axes(const ObjectModel& model);

// One line each: the exact symmetries, then the near ones; one line where there are none.
std::vector<std::string> symmetry_lines(const ObjectModel& model);

nlohmann::ordered_json symmetry_json(const ObjectModel& model);

}  // namespace binpick::app
