// How the feature maps of the descent lie in memory. Both give the same results bit for bit.
#pragma once

namespace binpick {

enum class MapLayout {
  kRearranged,  // blocks of 4x4 pixels and both modalities in 32 bytes (paper section III-C)
  kPlain,       // two images, row by row: the reference
};

}  // namespace binpick
