// Image files decoded into plain buffers; the only place that knows the decoder. Throws
// DatasetError.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace binpick::drivers {

template <class T>
struct ImageBuffer {
  int width = 0, height = 0;
  std::vector<T> pixels;  // rows without gaps
};

// One 16-bit channel, times `depth_scale`.
ImageBuffer<float> read_depth_mm(const std::string& path, double depth_scale);

// 8 bits; colour is converted to gray.
ImageBuffer<std::uint8_t> read_gray(const std::string& path);

}  // namespace binpick::drivers
