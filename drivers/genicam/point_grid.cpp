#include "genicam/point_grid.hpp"

#include <hwy/cache_control.h>

#include <algorithm>

#include "genicam/gray_rows.hpp"
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
// more than all the rest.
void keep_nearest(const float* points_mm, const std::int32_t* target, int count, float* depth_mm) {
  for (int i = 0; i < count; ++i) {
    const float held = depth_mm[target[i]], mine = points_mm[i];
    depth_mm[target[i]] = mine < held ? mine : held;
  }
}

void no_point_is_zero(std::ptrdiff_t count, float* depth_mm) {
  for (std::ptrdiff_t i = 0; i < count; ++i) depth_mm[i] = depth_mm[i] < kNoPoint ? depth_mm[i] : 0;
}

// Following the targets leaves the memory idle: the next row may come meanwhile.
void fetch_row(const PayloadPart& part, int y) {
  constexpr std::size_t kLineBytes = 64;
  if (y >= part.height) return;
  const std::uint8_t* row = part.row(y);
  const std::size_t bytes = row_bytes(part.format, part.width);
  for (std::size_t i = 0; i < bytes; i += kLineBytes) hwy::Prefetch(row + i);
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
                  const PayloadPart* grid_gray, GridScratch& scratch, float* depth_mm,
                  std::uint8_t* gray) {
  const PointAxes axes = axes_of(part, scan3d);
  const std::int32_t count = part.width * part.height;
  float* points_mm = scratch.depth_mm.data();
  std::int32_t* target = scratch.target.data();
  if (gray != nullptr) {
    scratch.window.begin(part.width, part.height, depth_mm, gray);
  } else {
    std::fill(depth_mm, depth_mm + count, kNoPoint);
  }
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* points = part.row(y);
    point_targets_row(axes, points, part.width, y, part.height, points_mm, target);
    confidence.apply(y, points_mm, kNoPoint);
    for (const PayloadPart* image : {&part, grid_gray, confidence.part()})
      if (image != nullptr) fetch_row(*image, y + 1);
    if (gray == nullptr) {
      keep_nearest(points_mm, target, part.width, depth_mm);
      continue;
    }
    if (grid_gray != nullptr) {
      gray_row(grid_gray->format, grid_gray->row(y), part.width, scratch.gray.data());
    } else {
      point_gray_row(points, part.width, scratch.gray.data());
    }
    scratch.window.add_row(points_mm, scratch.gray.data(), target, part.width);
  }
  if (gray != nullptr) {
    scratch.window.finish();
  } else {
    no_point_is_zero(count, depth_mm);
  }
}

void grid_gray(const PayloadPart& part, std::uint8_t* gray) {
  for (int y = 0; y < part.height; ++y, gray += part.width)
    point_gray_row(part.row(y), part.width, gray);
}

}  // namespace binpick::drivers
