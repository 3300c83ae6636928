// How surface normals are quantized into eight orientations.
#pragma once

#include <cstdint>

namespace binpick {

enum class NormalCodebook : std::uint8_t {
  kAzimuth = 0,  // the paper's: eight azimuths, 45 degrees each; undefined where the normal faces
                 // the camera
  kHemisphere = 1,  // one cell that faces the camera and seven azimuths around it
};

}  // namespace binpick
