// A colour picture in memory, as overlays and reports make it, and as a PNG. Thread: any; nothing
// is shared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "binpick/frame/frame.hpp"

namespace binpick::app {

struct Colour {
  std::uint8_t r = 255, g = 255, b = 255;
};

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows without gaps

  std::uint8_t* pixel(int x, int y) {
    return rgb.data() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
  }
  const std::uint8_t* pixel(int x, int y) const { return const_cast<Picture*>(this)->pixel(x, y); }
};

Picture picture_from_gray(ImageView<const std::uint8_t> gray);

// Depth from near (red) to far (blue), stretched between the 2nd and the 98th percentile of what
// was measured inside `roi`; black where nothing was.
Picture colour_map_depth(ImageView<const float> depth_mm, const Roi& roi);

// The part of the picture inside `roi` and `margin_px` around it; the whole where the ROI is the
// whole image.
Picture crop_to_roi(const Picture& picture, const Roi& roi, int margin_px);

std::vector<std::uint8_t> encode_png(const Picture& picture);

// Throws std::runtime_error naming the file.
void write_png(const Picture& picture, const std::string& path);

}  // namespace binpick::app
