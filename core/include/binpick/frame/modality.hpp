// Which of a frame's images poses are taken from.
#pragma once

#include "binpick/base/result.hpp"
#include "binpick/frame/frame.hpp"

namespace binpick {

enum class Modality : int {
  // What the frame has. A depth image is used wherever the frame has one, also where it holds no
  // measurement: a 3D sensor whose depth failed finds nothing, and does not go over to poses whose
  // distance is loose without anybody having asked for them.
  kAutomatic = 0,
  kDepthAndIntensity,
  kDepth,
  kIntensity,  // the distance follows from the size of the part's image
};
inline constexpr int kModalityCount = 4;
inline constexpr const char* kModalityNames[kModalityCount] = {"automatic", "depth_and_intensity",
                                                               "depth", "intensity"};

// The frame with only the images that are to be looked at. Errors: an image that was chosen is not
// there (kFrameWithoutDepth, kFrameWithoutIntensity), or none is (kFrameEmpty).
Result<Frame> seen_with(const Frame& frame, Modality modality);

}  // namespace binpick
