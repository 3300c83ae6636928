// From a depth image's code to millimetres: the one formula for files and for sensors, so that a
// frame from the wire and the same frame from its file have the same bits.
#pragma once

namespace binpick::drivers {

// In double, rounded to float once. Offset 0 gives the same bits as no offset.
inline float depth_mm_from_code(double code, double scale_mm, double offset_mm = 0) {
  return static_cast<float>(code * scale_mm + offset_mm);
}

}  // namespace binpick::drivers
