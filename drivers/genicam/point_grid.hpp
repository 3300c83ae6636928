// Depth from a grid of points (Coord3D_ABC*). Where each point lies on the ray of its own pixel the
// grid is the depth image; where the lens bends the rays the points are projected into the pinhole
// image, nearest first.
#pragma once

#include <cstdint>
#include <vector>

#include "genicam/confidence_rows.hpp"
#include "genicam/point_window.hpp"
#include "genicam/scan3d.hpp"

namespace binpick::drivers {

// Of a row: the points' depths, the pixels that they fall into, and their gray; and of the image
// the pixels that rows with gray are about to meet.
struct GridScratch {
  explicit GridScratch(int width_max)
      : depth_mm(static_cast<std::size_t>(width_max)),
        target(depth_mm.size()),
        gray(depth_mm.size()),
        window(width_max) {}
  std::vector<float> depth_mm;
  std::vector<std::int32_t> target;
  std::vector<std::uint8_t> gray;
  PointWindow window;
};

// True where all points lie within a pixel of their place in the grid: depth_mm is then the z of
// each, 0 where there is none. Else depth_mm is undefined.
bool grid_depth(const PayloadPart& part, const Scan3d& scan3d, float* depth_mm);

// Projects the grid's points, with their gray unless `gray` is null. `grid_gray`: the intensity
// image of the grid, of its size; null: what Coord3D_ABCY16 carries. Pixels that no point meets are
// 0 in both outputs; of points that meet in a pixel the nearest stays, of equal ones the first in
// the grid's order of rows.
void project_grid(const PayloadPart& part, const Scan3d& scan3d, const ConfidenceRows& confidence,
                  const PayloadPart* grid_gray, GridScratch& scratch, float* depth_mm,
                  std::uint8_t* gray);

// The intensity that Coord3D_ABCY16 carries as its fourth value, high byte.
void grid_gray(const PayloadPart& part, std::uint8_t* gray);

}  // namespace binpick::drivers
