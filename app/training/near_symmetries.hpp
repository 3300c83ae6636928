// Which near symmetries of a part detection cannot tell: counted in simulated piles, so that
// sensor, distance and noise decide, not the share of the surface that differs.
#pragma once

#include "binpick/train/trainer.hpp"
#include "training/pile_trial.hpp"

namespace binpick::app {

// With the symmetries that training found, so that no pose is wrong that nobody can tell from
// right: the exact ones, and those that are indistinguishable.
PartGeometry geometry_of(const ObjectModel& model, const train::Mesh& mesh);

// A near symmetry is indistinguishable where the best pose at a mostly visible part is turned by it
// more often than one time in five. The trial is of detection as if none were.
train::NearSymmetries indistinguishable_symmetries(const PileTrial& trial, const ObjectModel& model,
                                                   const train::Mesh& mesh,
                                                   const PoseLimits& limits);

}  // namespace binpick::app
