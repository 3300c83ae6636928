// A frame from an organized point cloud. Where each point lies on the ray of its pixel the cloud is
// the depth image; else, as with a lens that bends the rays, the points are projected into the
// image of a pinhole camera, nearest first.
#pragma once

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/depth_file.hpp"

namespace binpick::drivers {

// The cloud's points in mm, with `camera`'s intrinsics or, where they are not valid, those of the
// camera that fits the points. `intensity`: an image of the grid, instead of the cloud's own gray;
// empty: none. Throws DatasetError where the cloud has no grid, or no camera sees it so.
LoadedFrame frame_of_cloud(const std::string& path, const FileKind& kind, const FrameCamera& camera,
                           ImageBuffer<std::uint8_t> intensity, const DepthUnit& unit);

}  // namespace binpick::drivers
