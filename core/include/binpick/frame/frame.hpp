// The one frame type: every sensor, recording and test double produces it, every stage reads it. A
// Frame borrows its pixels; who fills the buffers keeps them alive for the call.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/camera_model.hpp"

namespace binpick {

// A rectangle of pixels. width or height 0 means: the whole image.
struct Roi {
  int x = 0, y = 0, width = 0, height = 0;
  bool whole_image() const { return width <= 0 || height <= 0; }
};

// The pixels of an image that a region takes in, from the first to one beyond the last.
struct PixelRange {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
};
inline PixelRange pixels_of(const Roi& roi, int width, int height) {
  if (roi.whole_image()) return {0, 0, width, height};
  const auto end = [](int begin, int size, int image_size) {
    const long long beyond = static_cast<long long>(begin) + size;  // more than an int, perhaps
    return static_cast<int>(std::clamp<long long>(beyond, 0, image_size));
  };
  const int x0 = std::clamp(roi.x, 0, width), y0 = std::clamp(roi.y, 0, height);
  return {x0, y0, std::max(x0, end(roi.x, roi.width, width)),
          std::max(y0, end(roi.y, roi.height, height))};
}

// No measurement is 0; NaN, infinite and negative values are read as no measurement too.
inline bool is_measured(float depth_mm) {
  return std::isfinite(depth_mm) && depth_mm > 0;
}

struct Frame {
  // Distance along the optical axis in mm, registered to the intensity image; see is_measured().
  ImageView<const float> depth_mm;
  // 8-bit gray, same size as the depth. Empty where the sensor has none.
  ImageView<const std::uint8_t> intensity;
  CameraIntrinsics camera;
  Roi roi;
  // When the frame's first byte reached this host, on its monotonic clock; 0: not known.
  std::int64_t capture_ns = 0;
  // The sensor's own clock at exposure, from an origin of its own; 0: the source has none.
  std::int64_t device_ns = 0;
  // As the source counts: gaps are frames that were lost on the way.
  std::uint64_t sequence = 0;
  // Where every depth is a whole number up to 65535 times this, rounded to float: the frame can be
  // kept in a 16-bit image without loss. 0: depths are any numbers.
  double depth_scale_mm = 0;
};

}  // namespace binpick
