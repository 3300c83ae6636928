// Depths as the 16-bit codes of a depth image. What a sensor sends as codes comes back bit for bit;
// what it sends as floats is rounded to such codes before anything is detected in it, so that what
// is recorded is what was detected. Pure. Thread-safe.
#pragma once

#include <cstdint>
#include <span>

#include "binpick/frame/frame_pool.hpp"

namespace binpick::app {

// Of frames from sensors that send floats. Depths of more than 6553.5 mm are no measurement then.
inline constexpr double kDepthStep_mm = 0.1;

// Rounds the slot's depths to multiples of `step_mm` and says so in its frame. A frame that has a
// scale already stays as it is.
void quantize_depth(FrameSlot& slot, double step_mm = kDepthStep_mm);

// Multiples of `scale_mm`, row by row without gaps; 0: no measurement. As many as the frame has
// pixels. Without loss where the scale is the frame's own.
void depth_codes(const Frame& frame, double scale_mm, std::span<std::uint16_t> codes);

}  // namespace binpick::app
