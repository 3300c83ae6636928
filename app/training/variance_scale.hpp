// By how much the covariance of poses has to grow to be that of the errors seen.
#pragma once

#include <optional>

#include "training/pile_trial.hpp"

namespace binpick::app {

// From the poses that are right, by the median of their errors in units of the covariance that the
// detector gave with the model's present scale; nothing where they are too few to tell. `centre_mm`
// of the part's bounding box, in the CAD's coordinates.
std::optional<double> growth_of_variance(const PileTrial& trial, const PartGeometry& geometry,
                                         const Vec3& centre_mm);

}  // namespace binpick::app
