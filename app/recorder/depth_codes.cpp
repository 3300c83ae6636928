#include "recorder/depth_codes.hpp"

#include "binpick/drivers/depth_code.hpp"

namespace binpick::app {
namespace {

// The nearest code; 0 for what is none (NaN, infinite, negative, beyond the last). Without
// branches, so that the compiler makes vectors of it. The product's error is far below half a code.
std::int32_t code_of(float depth_mm, double codes_per_mm) {
  const double code = static_cast<double>(depth_mm) * codes_per_mm + 0.5;
  const bool is_code = code >= 1 && code < 65536;
  return static_cast<std::int32_t>(is_code ? code : 0.0);
}

}  // namespace

void quantize_depth(FrameSlot& slot, double step_mm) {
  Frame& frame = slot.frame;
  if (frame.depth_scale_mm > 0 || frame.depth_mm.empty()) return;
  BINPICK_ASSERT(step_mm > 0);
  // The frame shows a part of the slot's own buffer.
  BINPICK_ASSERT(frame.depth_mm.data >= slot.depth_mm.data() &&
                 frame.depth_mm.data < slot.depth_mm.data() + slot.depth_mm.size());
  float* first = slot.depth_mm.data() + (frame.depth_mm.data - slot.depth_mm.data());
  const double codes_per_mm = 1 / step_mm;
  for (int y = 0; y < frame.depth_mm.height; ++y) {
    float* row = first + y * frame.depth_mm.stride;
    for (int x = 0; x < frame.depth_mm.width; ++x)
      row[x] = drivers::depth_mm_from_code(code_of(row[x], codes_per_mm), step_mm);
  }
  frame.depth_scale_mm = step_mm;
}

void depth_codes(const Frame& frame, double scale_mm, std::span<std::uint16_t> codes) {
  BINPICK_ASSERT(scale_mm > 0);
  const auto width = static_cast<std::size_t>(frame.depth_mm.width);
  BINPICK_ASSERT(codes.size() == width * static_cast<std::size_t>(frame.depth_mm.height));
  const double codes_per_mm = 1 / scale_mm;
  std::uint16_t* out = codes.data();
  for (int y = 0; y < frame.depth_mm.height; ++y, out += width) {
    const float* row = frame.depth_mm.row(y);
    for (std::size_t x = 0; x < width; ++x)
      out[x] = static_cast<std::uint16_t>(code_of(row[x], codes_per_mm));
  }
}

}  // namespace binpick::app
