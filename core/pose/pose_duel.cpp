#include "pose/pose_duel.hpp"

#include <algorithm>
#include <cmath>

#include "pose/contour.hpp"
#include "pose/verify.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kCells = PosePrediction::kCells;
// Log likelihood of a measured depth where a pose predicts another one, against none predicted.
constexpr double kAgrees = 3;
constexpr double kHides = -0.3;  // something lies in front: it is a pile
constexpr double kBehind = -4;   // nothing can be behind a surface
// Depths within a sensor's window are no independent witnesses.
constexpr double kWindowPx2 = 20;  // of the depth level
// Of a contour point: on an edge, beside none, and in the middle of a surface.
constexpr double kOnStep = 1.2, kOnEdge = 0.6, kOnNone = -0.8, kOnSurface = -1.5;
constexpr double kCreaseSeen = 0.6, kCreaseUnseen = -0.4;
constexpr int kDuelRangePx = 3;
// Between the cosines of two faces that meet at a crease.
constexpr float kBend = 0.2f;

int cell_of(const PredictionGrid& grid, const Vec2& depth_px, int& x, int& y) {
  x = static_cast<int>(std::floor((depth_px.x() - grid.left) / grid.step + 0.5));
  y = static_cast<int>(std::floor((depth_px.y() - grid.top) / grid.step + 0.5));
  return x >= 1 && y >= 1 && x < kCells - 1 && y < kCells - 1 ? y * kCells + x : -1;
}

// Paints the patch of surface that a sample stands for.
void paint(const Scene& scene, const PredictionGrid& grid, const Vec3& p, const Vec3& n,
           double spacing_mm, PosePrediction& out) {
  const double facing = -n.dot(p) / p.norm();
  if (facing < 0.05) return;
  const CameraIntrinsics& camera = scene.depth.camera;
  const Vec2 px = camera.project(p);
  const double reach = 0.5 * spacing_mm * camera.fx / (p.z() * grid.step) + 0.5;
  const double cx = (px.x() - grid.left) / grid.step, cy = (px.y() - grid.top) / grid.step;
  const int x0 = std::max(0, static_cast<int>(std::ceil(cx - reach))),
            x1 = std::min(kCells - 1, static_cast<int>(std::floor(cx + reach)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(cy - reach))),
            y1 = std::min(kCells - 1, static_cast<int>(std::floor(cy + reach)));
  const double along = n.dot(p);
  for (int y = y0; y <= y1; ++y) {
    const double v = (grid.top + y * grid.step - camera.cy) / camera.fy;
    for (int x = x0; x <= x1; ++x) {
      const double u = (grid.left + x * grid.step - camera.cx) / camera.fx;
      const double slope = n.x() * u + n.y() * v + n.z();
      const double z = slope < -1e-3 ? along / slope : p.z();
      const float depth =
          static_cast<float>(std::clamp(z, p.z() - 2 * spacing_mm, p.z() + 2 * spacing_mm));
      PosePrediction::Cell& cell = out.cells[static_cast<std::size_t>(y * kCells + x)];
      if (cell.depth_mm > 0 && cell.depth_mm <= depth) continue;
      cell = {depth, static_cast<float>(facing)};
    }
  }
}

void mark_edge(int cell, const Vec2& normal_px, PosePrediction& out) {
  const auto bits = static_cast<std::uint8_t>(edge_directions_near(normal_px));
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      std::uint8_t& at = out.edges[static_cast<std::size_t>(cell + dy * kCells + dx)];
      at = static_cast<std::uint8_t>(at | bits);
    }
  }
}

// Where the painted surface ends, steps or bends, the pose has a contour whatever its samples say:
// contours are thinned out, and left out at corners, for each viewpoint on its own.
void mark_rims(double step_mm, PosePrediction& out) {
  const auto rim_between = [&](const PosePrediction::Cell& a, const PosePrediction::Cell& b) {
    if (!(a.depth_mm > 0) || !(b.depth_mm > 0)) return (a.depth_mm > 0) != (b.depth_mm > 0);
    return std::fabs(a.depth_mm - b.depth_mm) > static_cast<float>(step_mm) ||
           std::fabs(a.facing - b.facing) > kBend;
  };
  for (int y = 1; y < kCells - 1; ++y) {
    for (int x = 1; x < kCells - 1; ++x) {
      const int i = y * kCells + x;
      const PosePrediction::Cell* cell = &out.cells[static_cast<std::size_t>(i)];
      if (!rim_between(cell[0], cell[1]) && !rim_between(cell[0], cell[kCells])) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx)
          out.edges[static_cast<std::size_t>(i + dy * kCells + dx)] = 0xFF;
      }
    }
  }
}

// Of a measured depth z where `cell` is predicted.
double depth_value(const PosePrediction::Cell& cell, double z, double sigma_mm) {
  if (!(cell.depth_mm > 0)) return 0;
  const double r =
      (z - static_cast<double>(cell.depth_mm)) * static_cast<double>(cell.facing) / sigma_mm;
  return std::max(kAgrees - 0.5 * r * r, r < 0 ? kHides : kBehind);
}

double depth_odds(const Scene& scene, const PredictionGrid& grid, const PosePrediction& a,
                  const PosePrediction& b, double sigma_mm) {
  const auto differs = [&](int i) {
    const PosePrediction::Cell &ca = a.cells[static_cast<std::size_t>(i)],
                               &cb = b.cells[static_cast<std::size_t>(i)];
    const bool in_a = ca.depth_mm > 0, in_b = cb.depth_mm > 0;
    if (!in_a || !in_b) return in_a != in_b;
    return static_cast<double>(std::fabs(ca.depth_mm - cb.depth_mm) *
                               std::min(ca.facing, cb.facing)) > 2 * sigma_mm;
  };
  double sum = 0;
  for (int y = 1; y < kCells - 1; ++y) {
    for (int x = 1; x < kCells - 1; ++x) {
      const int i = y * kCells + x;
      // Rims that differ by the last pixel say nothing.
      if (!differs(i) || !differs(i - 1) || !differs(i + 1) || !differs(i - kCells) ||
          !differs(i + kCells))
        continue;
      const double z = scene.depth_at(grid.left + x * grid.step, grid.top + y * grid.step);
      if (!(z > 0)) continue;
      sum += depth_value(a.cells[static_cast<std::size_t>(i)], z, sigma_mm) -
             depth_value(b.cells[static_cast<std::size_t>(i)], z, sigma_mm);
    }
  }
  return sum * std::min(1.0, grid.step * grid.step / kWindowPx2);
}

double contour_value(const Scene& scene, const ContourPlace& place, bool outline,
                     double tolerance_mm) {
  if (outline && on_depth_edge(scene, place.point_cam, place.normal_px)) return kOnStep;
  const ContourMatch m = match_contour(place, scene, kDuelRangePx);
  const double near = m.found ? 1 - std::abs(m.offset_px) / (kDuelRangePx + 1) : 0;
  if (!outline) return m.found ? kCreaseSeen * near : kCreaseUnseen;
  if (m.found) return kOnEdge * near;
  return surface_continues(scene, place, tolerance_mm) ? kOnSurface : kOnNone;
}

// Contours of one pose where the other has none.
double contour_odds(const ObjectModel& model, const Scene& scene, const PredictionGrid& grid,
                    const Pose& T, const PosePrediction& other) {
  const double tolerance_mm = contour_tolerance_mm(model, scene, T);
  double sum = 0;
  for (const ContourSample& s : model.contour(nearest_viewpoint(model, T))) {
    const bool outline = s.is_silhouette >= 0.5f;
    if (!outline && !scene.with_intensity) continue;
    const ContourPlace place = place_contour(s, scene, T, kDuelRangePx, tolerance_mm);
    if (!place.visible) continue;
    int x = 0, y = 0;
    const int cell = cell_of(grid, scene.depth.camera.project(place.point_cam), x, y);
    if (cell < 0) continue;
    const auto at = static_cast<std::size_t>(cell);
    if ((other.edges[at] & (1u << edge_direction(place.normal_px))) != 0) continue;
    sum += contour_value(scene, place, outline, tolerance_mm);
  }
  return sum;
}

}  // namespace

PredictionGrid::PredictionGrid(const ObjectModel& model, const Scene& scene, const Vec3& middle) {
  const CameraIntrinsics& camera = scene.depth.camera;
  const double reach_px = 0.75 * model.info().diameter_mm * camera.fx / middle.z() + 2;
  step = std::max(1, static_cast<int>(std::ceil(2 * reach_px / kCells)));
  const Vec2 px = camera.project(middle);
  left = static_cast<int>(std::lround(px.x())) - step * kCells / 2;
  top = static_cast<int>(std::lround(px.y())) - step * kCells / 2;
}

void predict(const ObjectModel& model, const Scene& scene, const PredictionGrid& grid,
             const Pose& T, PosePrediction& out) {
  out.cells.fill({});
  out.edges.fill(0);
  const Viewpoint& view = nearest_viewpoint(model, T);
  const double spacing_mm = std::sqrt(static_cast<double>(view.sample_area_mm2));
  for (const SurfaceSample& s : model.surface(view))
    paint(scene, grid, T * position_of(s), T.R * normal_of(s), spacing_mm, out);
  const double tolerance_mm = contour_tolerance_mm(model, scene, T);
  for (const ContourSample& s : model.contour(view)) {
    const ContourPlace place = place_contour(s, scene, T, kDuelRangePx, tolerance_mm);
    int x = 0, y = 0;
    const int cell = cell_of(grid, scene.depth.camera.project(T * position_of(s)), x, y);
    if (cell >= 0 && !place.normal_px.isZero()) mark_edge(cell, place.normal_px, out);
  }
  mark_rims(2 * scene.depth_error_mm(T.t_mm.z()) + spacing_mm, out);
}

double duel(const ObjectModel& model, const Scene& scene, const PredictionGrid& grid, const Pose& a,
            const PosePrediction& of_a, const Pose& b, const PosePrediction& of_b) {
  const double sigma_mm = scene.depth_error_mm(a.t_mm.z());
  return depth_odds(scene, grid, of_a, of_b, sigma_mm) + contour_odds(model, scene, grid, a, of_b) -
         contour_odds(model, scene, grid, b, of_a);
}

}  // namespace binpick
