#include "pose/explain.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/base/arena_plan.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kCellPx = 2;  // at the depth level
// A sample this close to the measured surface explains it.
constexpr double kExplainsRatio = 0.005;

std::size_t cell_count(int width, int height) {
  return static_cast<std::size_t>(width / kCellPx + 1) *
         static_cast<std::size_t>(height / kCellPx + 1);
}

}  // namespace

std::size_t SceneOwnership::footprint(int width_max, int height_max) {
  ArenaPlan plan;
  plan.take<std::uint8_t>(cell_count(width_max, height_max));
  return plan.bytes;
}

SceneOwnership::SceneOwnership(int width_max, int height_max, Arena& arena)
    : owned_(arena.take<std::uint8_t>(cell_count(width_max, height_max))) {}

void SceneOwnership::clear(const Scene& scene) {
  columns_ = scene.depth.width / kCellPx + 1;
  rows_ = scene.depth.height / kCellPx + 1;
  std::fill_n(owned_.begin(), columns_ * rows_, std::uint8_t{0});
}

template <class Visit>
void SceneOwnership::visit_cells(const ObjectModel& model, const Scene& scene, const Pose& T,
                                 Visit&& visit) const {
  for (const SurfaceSample& s : model.surface(nearest_viewpoint(model, T))) {
    const Vec3 p = T * position_of(s);
    const auto [u, v, z] = scene.measured_at(p);
    const bool explained =
        scene.with_depth ? z > 0 && std::abs(z - p.z()) < kExplainsRatio * p.z()
                         : u >= 0 && v >= 0 && u < scene.depth.width && v < scene.depth.height;
    if (explained) visit(u / kCellPx, v / kCellPx);
  }
}

double SceneOwnership::owned_share(const ObjectModel& model, const Scene& scene,
                                   const Pose& T) const {
  int total = 0, taken = 0;
  visit_cells(model, scene, T, [&](int x, int y) {
    ++total;
    taken += owned_[static_cast<std::size_t>(y * columns_ + x)];
  });
  return total > 0 ? static_cast<double>(taken) / total : 0;
}

void SceneOwnership::claim(const ObjectModel& model, const Scene& scene, const Pose& T) {
  visit_cells(model, scene, T, [&](int cx, int cy) {
    for (int y = std::max(0, cy - 1); y <= std::min(rows_ - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x)
        owned_[static_cast<std::size_t>(y * columns_ + x)] = 1;
    }
  });
}

}  // namespace binpick
