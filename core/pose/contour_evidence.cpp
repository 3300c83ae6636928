#include "pose/contour_evidence.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/directed_edge.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kRangePx = 3;
// Gray levels per pixel from which something is an edge, away from the contours.
constexpr double kStrayGradient = 4;
constexpr int kSides = 6;

// Cells of the image at or beside a contour point of the part.
class ContourCells {
 public:
  ContourCells(const ObjectModel& model, const Scene& scene, const Pose& T) {
    const CameraIntrinsics& camera = scene.intensity.camera;
    const double reach_px = 0.6 * model.info().diameter_mm * camera.fx / T.t_mm.z() + 2;
    cell_px_ = std::max(4.0, 2 * reach_px / kCells);
    first_ = camera.project(T.t_mm) - Vec2(kCells, kCells) * cell_px_ / 2;
  }
  void mark(const Vec2& pixel) {
    const auto [x, y] = cell_of(pixel);
    if (x < 1 || y < 1 || x >= kCells - 1 || y >= kCells - 1) return;
    for (int k = y - 1; k <= y + 1; ++k) rows_[static_cast<std::size_t>(k)] |= 7ull << (x - 1);
  }
  bool marked(const Vec2& pixel) const {
    const auto [x, y] = cell_of(pixel);
    if (x < 0 || y < 0 || x >= kCells || y >= kCells) return true;
    return (rows_[static_cast<std::size_t>(y)] >> x & 1) != 0;
  }

 private:
  static constexpr int kCells = 64;
  struct Cell {
    int x, y;
  };
  Cell cell_of(const Vec2& pixel) const {
    const Vec2 c = (pixel - first_) / cell_px_;
    return {static_cast<int>(std::floor(c.x())), static_cast<int>(std::floor(c.y()))};
  }

  std::array<std::uint64_t, kCells> rows_{};
  double cell_px_ = 0;
  Vec2 first_;
};

// The outline's support all around: a pose that fits one side of something else has none on the
// other sides.
struct Sides {
  std::array<double, kSides> supported{};
  std::array<int, kSides> count{};

  void add(const Vec2& from_centre, double support) {
    const double turn = std::atan2(from_centre.y(), from_centre.x()) / (2 * kPi) + 0.5;
    const auto side =
        static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSides), 0, kSides - 1));
    supported[side] += support;
    ++count[side];
  }
  double weakest() const {
    double least = 1;
    for (std::size_t i = 0; i < kSides; ++i) {
      if (count[i] >= 4) least = std::min(least, supported[i] / count[i]);
    }
    return least;
  }
};

double support_of(const ContourMatch& m) {
  return m.found ? 1 - std::abs(m.offset_px) / (kRangePx + 1) : 0;
}

void add_contours(const ObjectModel& model, const Scene& scene, const Pose& T,
                  const Viewpoint& view, ContourCells& cells, Evidence& e) {
  Sides sides;
  const Vec2 centre = scene.intensity.camera.project(T.t_mm);
  for (const ContourSample& s : model.contour(view)) {
    const ContourPlace place = place_contour(s, scene, T, kRangePx, 0);
    cells.mark(place.pixel);
    if (!place.visible) continue;
    const ContourMatch m = match_directed(place, scene, kRangePx);
    const double support = support_of(m);
    if (s.is_silhouette < 0.5f) {
      ++e.creases;
      e.creases_supported += support;
      continue;
    }
    ++e.contours;
    e.contours_supported += support;
    sides.add(place.pixel - centre, support);
    if (m.found) {
      ++e.outline_matches;
      e.outline_offset_px += std::abs(m.offset_px);
    } else {
      e.outline_continued += !match_contour(place, scene, kRangePx).found;
    }
  }
  e.weakest_side = sides.weakest();
}

void add_surface(const ObjectModel& model, const Scene& scene, const Pose& T, const Viewpoint& view,
                 const ContourCells& cells, Evidence& e) {
  const double view_area = static_cast<double>(view.sample_area_mm2);
  const double support = e.contour_support();
  const Vec3 sampled_from = -viewing_direction(view);
  const PyramidLevel& level = scene.intensity;
  for (const SurfaceSample& s : model.surface(view)) {
    const Vec3 p = T * position_of(s);
    const Vec2 pixel = level.camera.project(p);
    ++e.samples;
    ++e.unknown;
    if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < level.width &&
          pixel.y() < level.height)) {
      continue;
    }
    const double facing = -(T.R * normal_of(s)).dot(p) / p.norm(),
                 facing_then = normal_of(s).dot(sampled_from);
    e.explained_mm2 +=
        support * view_area * std::clamp(facing / std::max(facing_then, 0.05), 0.0, 2.0);
    if (cells.marked(pixel)) continue;
    ++e.plain;
    e.stray_edges += gray_gradient(scene, pixel).norm() > kStrayGradient;
  }
}

}  // namespace

double contour_promise(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const PyramidLevel& level = scene.depth;  // the level of the features
  double sum = 0;
  int count = 0;
  for (const ContourSample& s : model.contour(nearest_viewpoint(model, T))) {
    const ContourPlace place = place_contour(s, scene, T, kRangePx, 0);
    ++count;
    if (!place.visible) continue;
    const Vec2 px = level.camera.project(place.point_cam);
    const int u = nearest_pixel(px.x()), v = nearest_pixel(px.y());
    if (u < 0 || v < 0 || u >= level.width || v >= level.height) continue;
    const unsigned bits = level.plain.gradient[v * level.plain.stride + u];
    // By chance one of the three directions near the contour's is among those of any k.
    static constexpr double kChance[9] = {0, 0.375, 0.643, 0.821, 0.929, 0.982, 1, 1, 1};
    const double chance = kChance[std::popcount(bits)];
    sum += ((bits & edge_directions_near(place.normal_px)) != 0 ? 1 : 0) - chance;
    sum -= bits == 0 ? 0.2 : 0;
  }
  return count > 0 ? sum / count : 0;
}

Evidence contour_evidence(const ObjectModel& model, const Scene& scene, const Pose& T) {
  Evidence e;
  const Viewpoint& view = nearest_viewpoint(model, T);
  e.seen = Modality::kIntensity;
  e.px2_per_mm2 = scene.px2_per_mm2(T.t_mm.z());
  ContourCells cells(model, scene, T);
  add_contours(model, scene, T, view, cells, e);
  add_surface(model, scene, T, view, cells, e);
  return e;
}

}  // namespace binpick
