#include "genicam/point_grid.hpp"

#include <algorithm>

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
  std::fill(depth_mm, depth_mm + count, 0.0f);
  if (grid_gray != nullptr) std::fill(gray, gray + count, std::uint8_t{0});
  float* row_mm = scratch.depth_mm.data();
  std::int32_t* target = scratch.target.data();
  for (int y = 0; y < part.height; ++y) {
    point_depth_row(axes, part.row(y), part.width, row_mm);
    confidence.apply(y, row_mm);
    point_targets_row(axes, part.row(y), part.width, row_mm, part.width, part.height, target);
    const std::uint8_t* row_gray =
        grid_gray == nullptr ? nullptr : grid_gray + static_cast<std::ptrdiff_t>(y) * part.width;
    for (int x = 0; x < part.width; ++x) {
      const std::int32_t to = target[x];
      if (to < 0 || (depth_mm[to] != 0 && depth_mm[to] <= row_mm[x])) continue;
      depth_mm[to] = row_mm[x];
      if (row_gray != nullptr) gray[to] = row_gray[x];
    }
  }
}

void grid_gray(const PayloadPart& part, std::uint8_t* gray) {
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* row = part.row(y);
    for (int x = 0; x < part.width; ++x) *gray++ = row[8 * x + 7];
  }
}

}  // namespace binpick::drivers
