#include "pose/explain.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/base/arena_plan.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kCellPx = 2;  // at the depth level

std::size_t cell_count(int width, int height) {
  return static_cast<std::size_t>(width / kCellPx + 1) *
         static_cast<std::size_t>(height / kCellPx + 1);
}

std::size_t vote_count(int owners_max) {
  return static_cast<std::size_t>(owners_max) + 1;
}

}  // namespace

std::size_t SceneOwnership::footprint(int width_max, int height_max, int owners_max,
                                      int thread_count) {
  ArenaPlan plan;
  plan.take<std::uint16_t>(cell_count(width_max, height_max));
  plan.take<int>(vote_count(owners_max) * static_cast<std::size_t>(thread_count));
  return plan.bytes;
}

SceneOwnership::SceneOwnership(int width_max, int height_max, int owners_max, int thread_count,
                               Arena& arena)
    : owned_(arena.take<std::uint16_t>(cell_count(width_max, height_max))),
      votes_(arena.take<int>(vote_count(owners_max) * static_cast<std::size_t>(thread_count))),
      votes_per_thread_(vote_count(owners_max)) {}

void SceneOwnership::clear(const Scene& scene) {
  columns_ = scene.depth.width / kCellPx + 1;
  rows_ = scene.depth.height / kCellPx + 1;
  std::fill_n(owned_.begin(), columns_ * rows_, std::uint16_t{0});
}

template <class Visit>
void SceneOwnership::visit_cells(const ObjectModel& model, const Scene& scene, const Pose& T,
                                 Visit&& visit) const {
  for (const SurfaceSample& s : model.surface(nearest_viewpoint(model, T))) {
    const Vec3 p = T * position_of(s);
    const Scene::Measurement m = scene.measured_at(p);
    const auto [u, v, z] = m;
    // What lies on a thin part does not belong to the one below.
    const bool explained =
        scene.with_depth ? scene.lies_on_measured(m, p, T.R * normal_of(s), T.t_mm.z())
                         : u >= 0 && v >= 0 && u < scene.depth.width && v < scene.depth.height;
    if (explained) visit(u / kCellPx, v / kCellPx);
  }
}

SceneOwnership::Owned SceneOwnership::owned(const ObjectModel& model, const Scene& scene,
                                            const Pose& T, int thread) const {
  const std::span<int> votes =
      votes_.subspan(static_cast<std::size_t>(thread) * votes_per_thread_, votes_per_thread_);
  std::fill(votes.begin(), votes.end(), 0);
  int total = 0;
  visit_cells(model, scene, T, [&](int x, int y) {
    ++total;
    ++votes[owned_[static_cast<std::size_t>(y * columns_ + x)]];
  });
  if (total == votes[0]) return {};
  const auto most = std::max_element(votes.begin() + 1, votes.end());
  return {static_cast<double>(total - votes[0]) / total,
          static_cast<int>(most - votes.begin()) - 1};
}

void SceneOwnership::claim(const ObjectModel& model, const Scene& scene, const Pose& T, int owner) {
  visit_cells(model, scene, T, [&](int cx, int cy) {
    for (int y = std::max(0, cy - 1); y <= std::min(rows_ - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x) {
        std::uint16_t& cell = owned_[static_cast<std::size_t>(y * columns_ + x)];
        if (cell == 0) cell = static_cast<std::uint16_t>(owner + 1);
      }
    }
  });
}

}  // namespace binpick
