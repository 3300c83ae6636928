// Kernels for rows of points (Coord3D_ABC*). The scalar functions are the specification and ship;
// the vector ones are one Highway source for every vector unit, chosen at run time, and give the
// same bits. Points are little-endian, at any address; nothing is read or written beyond a row.
#pragma once

#include <cstdint>

#include "genicam/depth_table.hpp"

namespace binpick::drivers {

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
// target[x] = index of the pixel, in an image of image_width x image_height, that the point falls
// into; -1 outside and where depth_mm[x] is 0. image_width * image_height fits an int.
void point_targets_row_scalar(const PointAxes& axes, const std::uint8_t* points, int width,
                              const float* depth_mm, int image_width, int image_height,
                              std::int32_t* target);

void point_depth_row(const PointAxes& axes, const std::uint8_t* points, int width, float* depth_mm);
// x_begin is 0.
bool points_on_rays(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                    const float* depth_mm);
void point_targets_row(const PointAxes& axes, const std::uint8_t* points, int width,
                       const float* depth_mm, int image_width, int image_height,
                       std::int32_t* target);

}  // namespace binpick::drivers
