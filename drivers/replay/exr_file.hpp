// OpenEXR images, as renderers write depth.
#pragma once

#include "replay/image_file.hpp"

namespace binpick::drivers {

// The only channel, or the one that is called Z, V, Y or depth (also of a layer: "Depth.V"). Throws
// DatasetError that lists the channels.
RawDepth read_exr_depth(const std::string& path);

}  // namespace binpick::drivers
