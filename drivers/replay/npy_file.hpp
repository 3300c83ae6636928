// NumPy's .npy, as numpy.save writes a depth image.
#pragma once

#include "replay/image_file.hpp"

namespace binpick::drivers {

// float32, float64, float16 or uint16, height x width. Throws DatasetError, with what to do in
// Python.
RawDepth read_npy_depth(const std::string& path);

}  // namespace binpick::drivers
