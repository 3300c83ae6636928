// Depth from a grid of points (Coord3D_ABC*): where each point lies on the ray of its own pixel the
// grid is the depth image; where the lens bends the rays the points are projected into the pinhole
// image, nearest first.
#pragma once

#include <cstdint>

#include "genicam/payload_converter.hpp"

namespace binpick::drivers {

// z of each point, 0 where there is none; true where all points lie within a pixel of their place
// in the grid.
bool grid_depth(const PayloadPart& part, const Scan3d& scan3d, float* depth_mm);

// Projects the grid's points. `grid_mm`: as grid_depth gives it, with unsure points removed;
// `grid_gray` may be null. Pixels that no point meets are 0 in both outputs.
void project_grid(const PayloadPart& part, const Scan3d& scan3d, const float* grid_mm,
                  const std::uint8_t* grid_gray, float* depth_mm, std::uint8_t* gray);

// The intensity that Coord3D_ABCY16 carries as its fourth value, high byte.
void grid_gray(const PayloadPart& part, std::uint8_t* gray);

}  // namespace binpick::drivers
