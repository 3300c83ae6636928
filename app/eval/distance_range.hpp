// How far from the camera a part can lie, as training has to know it: from depth images alone,
// never from truth, so that a data set says no more than a commissioned cell would.
#pragma once

#include <optional>
#include <vector>

#include "binpick/frame/frame.hpp"

namespace binpick::app {

struct DistanceRange {
  double min_mm = 0, max_mm = 0;  // from the camera's centre, along the ray
};

// Between the 1st and the 99th percentile of what was measured inside the ROI; nothing when there
// are too few measurements to tell.
std::optional<DistanceRange> measured_range(const Frame& frame);

// The range that covers all frames, widened by half the diameter on both sides (the origin of a
// part lies behind the surface that is seen), where the camera can recognise the part: not so near
// that it does not fit into the image, not so far that it shrinks to a few pixels (a room seen
// behind the table would ask for training that is of no use). Rounded outwards, so that small
// changes of the data do not ask for new training. Nothing when `measured` is empty.
std::optional<DistanceRange> training_range(const std::vector<DistanceRange>& measured,
                                            double diameter_mm, const CameraIntrinsics& camera);

}  // namespace binpick::app
