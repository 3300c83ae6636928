// Image files decoded into plain buffers; the only place that knows the decoders. Throws
// DatasetError.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

namespace binpick::drivers {

template <class T>
struct ImageBuffer {
  int width = 0, height = 0;
  std::vector<T> pixels;  // rows without gaps
};

// A depth image as its file holds it: whole numbers, or numbers. One of the two is empty.
struct RawDepth {
  int width = 0, height = 0;
  cv::Mat_<std::uint16_t> codes;  // as decoded: a recording's reader copies no image without need
  std::vector<float> values;
};

// "1280x1024", for messages.
std::string size_text(int width, int height);

// One channel of 16 bits or of floating point (PNG, TIFF, PFM, ...).
RawDepth read_depth_image(const std::string& path);

// Colour is converted to gray. 16 bits a channel become 8: how many of them the image uses (8, 10,
// 12, 14 or 16) follows from its brightest pixel.
ImageBuffer<std::uint8_t> read_gray(const std::string& path);

// The same for values up to 65535.
std::vector<std::uint8_t> gray_of_codes(std::span<const std::uint16_t> codes);

}  // namespace binpick::drivers
