// The last stages of a detection, begun at a known pose.
#pragma once

#include "detect/near_reference.hpp"
#include "detect/stage_observer.hpp"
#include "pose/explain.hpp"

namespace binpick {

// `ownership` is scratch, for the region of the cycle. Fills everything of the finding but its
// sightings and the last drop.
void start_from_reference(const ObservedCycle& cycle, const ReferencePose& reference,
                          const ReferenceLimits& limits, SceneOwnership& ownership,
                          ReferenceFinding& finding);

}  // namespace binpick
