// Removes lens distortion from a frame that was read from files.
#pragma once

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {

// Both images, or the intensity alone. Nothing happens where the lens has no distortion. Throws
// DatasetError, naming `path`, where the coefficients do not hold up to the image's corners.
void undistort(const std::string& path, const LensDistortion& lens, LoadedFrame& frame);
void undistort_intensity(const std::string& path, const LensDistortion& lens, LoadedFrame& frame);

}  // namespace binpick::drivers
