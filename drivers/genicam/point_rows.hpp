// Kernels for rows of points (Coord3D_ABC*). The scalar functions are the specification and ship;
// the vector ones are one Highway source for every vector unit, chosen at run time, and give the
// same bits. Points are little-endian, at any address; nothing is read or written beyond a row.
#pragma once

#include <cstdint>
#include <limits>

#include "genicam/depth_table.hpp"

namespace binpick::drivers {

// Depth of no point where points compete for pixels: farther than all others.
constexpr float kNoPoint = std::numeric_limits<float>::infinity();

enum class PointLayout { kAbc32f, kAbc16, kAbcy16 };

// x and y only choose a pixel: float is enough.
struct AxisInPx {
  float scale, offset;  // of the code, to focal length times coordinate in mm
  AxisInPx(const Scan3dAxis& axis, double px_per_unit)
      : scale(static_cast<float>(axis.scale * px_per_unit)),
        offset(static_cast<float>(axis.offset * px_per_unit)) {}
  float times_z(float code) const { return code * scale + offset; }
};

struct PointAxes {
  PointLayout layout;
  AxisInPx a, b;
  AxisInMm c;
  float cu, cv;  // principal point, px
};

// depth_mm[x] = z of each point, 0 where there is none.
void point_depth_row_scalar(const PointAxes& axes, const std::uint8_t* points, int width,
                            float* depth_mm);
// True where each point of columns x_begin .. width-1 that has depth lies within a pixel of its
// place: column x, row y.
bool points_on_rays_scalar(const PointAxes& axes, const std::uint8_t* points, int x_begin,
                           int width, int y, const float* depth_mm);
// Projects the points of row y into an image of `width` columns and `image_height` rows:
// depth_mm[x] as above, target[x] = index of the pixel that the point falls into. A point without
// depth, or outside of the image, gets kNoPoint and its own place as target: so that whoever
// follows the targets needs no branch, and many such points do not all meet in one pixel. width *
// image_height fits an int.
void point_targets_row_scalar(const PointAxes& axes, const std::uint8_t* points, int x_begin,
                              int width, int y, int image_height, float* depth_mm,
                              std::int32_t* target);
// gray[x] = the high byte of each point's fourth value; the layout is kAbcy16.
void point_gray_row_scalar(const std::uint8_t* points, int width, std::uint8_t* gray);

// The same, from x_begin 0.
void point_depth_row(const PointAxes& axes, const std::uint8_t* points, int width, float* depth_mm);
bool points_on_rays(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                    const float* depth_mm);
void point_targets_row(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                       int image_height, float* depth_mm, std::int32_t* target);
void point_gray_row(const std::uint8_t* points, int width, std::uint8_t* gray);

}  // namespace binpick::drivers
