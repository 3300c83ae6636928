#include "genicam/point_grid.hpp"

#include <algorithm>
#include <bit>

#include "genicam/point_rows.hpp"

namespace binpick::drivers {
namespace {

PointLayout layout_of(PixelFormat format) {
  if (format == PixelFormat::kCoord3dAbc32f) return PointLayout::kAbc32f;
  return format == PixelFormat::kCoord3dAbcy16 ? PointLayout::kAbcy16 : PointLayout::kAbc16;
}

PointAxes axes_of(const PayloadPart& part, const Scan3d& s) {
  const double px_per_unit = s.mm_per_unit * s.focal_length_px;
  return {layout_of(part.format),
          AxisInPx(s.a, px_per_unit),
          AxisInPx(s.b, px_per_unit * s.aspect_ratio),
          AxisInMm(s.c, s.mm_per_unit),
          static_cast<float>(s.principal_u_px),
          static_cast<float>(s.principal_v_px)};
}

// Without a branch: which of two points is the nearer nobody can predict, and a wrong guess costs
// more than all the rest. The depth goes through the unit for floats, whose minimum is one
// instruction; the gray through the one for integers, beside it.

void keep_nearest(const float* points_mm, const std::int32_t* target, int count, float* depth_mm) {
  for (int i = 0; i < count; ++i) {
    const float held = depth_mm[target[i]], mine = points_mm[i];
    depth_mm[target[i]] = mine < held ? mine : held;
  }
}

void keep_nearest(const float* points_mm, const std::uint8_t* points_gray,
                  const std::int32_t* target, int count, float* depth_mm, std::uint8_t* gray) {
  for (int i = 0; i < count; ++i) {
    const std::int32_t to = target[i];
    const float held = depth_mm[to], mine = points_mm[i];
    // Depths are positive: their bits are in their order.
    const std::uint32_t nearer =  // all bits or none
        0u - static_cast<std::uint32_t>(std::bit_cast<std::uint32_t>(mine) <
                                        std::bit_cast<std::uint32_t>(held));
    depth_mm[to] = mine < held ? mine : held;
    gray[to] = static_cast<std::uint8_t>(gray[to] ^ ((gray[to] ^ points_gray[i]) & nearer));
  }
}

void no_point_is_zero(std::ptrdiff_t count, float* depth_mm) {
  for (std::ptrdiff_t i = 0; i < count; ++i) depth_mm[i] = depth_mm[i] < kNoPoint ? depth_mm[i] : 0;
}

}  // namespace

bool grid_depth(const PayloadPart& part, const Scan3d& scan3d, float* depth_mm) {
  const PointAxes axes = axes_of(part, scan3d);
  for (int y = 0; y < part.height; ++y, depth_mm += part.width) {
    point_depth_row(axes, part.row(y), part.width, depth_mm);
    if (!points_on_rays(axes, part.row(y), part.width, y, depth_mm)) return false;
  }
  return true;
}

void project_grid(const PayloadPart& part, const Scan3d& scan3d, const ConfidenceRows& confidence,
                  const std::uint8_t* grid_gray, GridScratch& scratch, float* depth_mm,
                  std::uint8_t* gray) {
  const PointAxes axes = axes_of(part, scan3d);
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(part.width) * part.height;
  float* points_mm = scratch.depth_mm.data();
  std::int32_t* target = scratch.target.data();
  std::fill(depth_mm, depth_mm + count, kNoPoint);
  if (gray != nullptr) std::fill(gray, gray + count, std::uint8_t{0});
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* points = part.row(y);
    point_targets_row(axes, points, part.width, y, part.height, points_mm, target);
    confidence.apply(y, points_mm, kNoPoint);
    if (gray == nullptr) {
      keep_nearest(points_mm, target, part.width, depth_mm);
      continue;
    }
    const std::uint8_t* row_gray = scratch.gray.data();
    if (grid_gray != nullptr) {
      row_gray = grid_gray + static_cast<std::ptrdiff_t>(y) * part.width;
    } else {
      point_gray_row(points, part.width, scratch.gray.data());
    }
    keep_nearest(points_mm, row_gray, target, part.width, depth_mm, gray);
  }
  no_point_is_zero(count, depth_mm);
}

void grid_gray(const PayloadPart& part, std::uint8_t* gray) {
  for (int y = 0; y < part.height; ++y, gray += part.width)
    point_gray_row(part.row(y), part.width, gray);
}

}  // namespace binpick::drivers
