// The last stages of a detection, begun at a known pose.
#pragma once

#include "detect/stage_observer.hpp"
#include "diagnosis/near_reference.hpp"
#include "pose/coverage.hpp"

namespace binpick {

// `coverage` is scratch, for the region of the cycle. Fills everything of the finding but its
// sightings and the last drop.
void start_from_reference(const ObservedCycle& cycle, const ReferencePose& reference,
                          const ReferenceLimits& limits, Coverage& coverage,
                          ReferenceFinding& finding);

}  // namespace binpick
