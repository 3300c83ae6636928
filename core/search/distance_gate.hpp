// Measured depth rules out most distances of a template at most places.
#pragma once

#include "binpick/model/object_model.hpp"
#include "features/pyramid.hpp"

namespace binpick {

class DistanceGate {
 public:
  explicit DistanceGate(const ObjectModel& model) : model_(model) {}

  // Whether a part at the given distance of tree depth d may stand at the 2x2 quad whose first
  // pixel is (x, y): some pixel of or around the quad shows a surface where the part's would be.
  // Without any measurement there the distance is allowed.
  bool allows(const PyramidLevel& level, int x, int y, int d, int distance_index) const;

 private:
  const ObjectModel& model_;
};

}  // namespace binpick
