#include "pose/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/base/arena_plan.hpp"
#include "pose/tolerances.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kCellPx = 2;  // at the depth level

}  // namespace

template <class Source>
Coverage::Buffers Coverage::take(int width_max, int height_max, int owners_max, int thread_count,
                                 Source& source) {
  const auto owners = static_cast<std::size_t>(owners_max);
  Buffers b;
  b.cells = source.template take<std::uint16_t>(static_cast<std::size_t>(width_max / kCellPx + 1) *
                                                static_cast<std::size_t>(height_max / kCellPx + 1));
  b.votes = source.template take<int>((owners + 1) * static_cast<std::size_t>(thread_count));
  b.owners = source.template take<Hypothesis*>(owners);
  return b;
}

std::size_t Coverage::footprint(int width_max, int height_max, int owners_max, int thread_count) {
  ArenaPlan plan;
  take(width_max, height_max, owners_max, thread_count, plan);
  return plan.bytes;
}

Coverage::Coverage(int width_max, int height_max, int owners_max, int thread_count, Arena& arena)
    : buffers_(take(width_max, height_max, owners_max, thread_count, arena)) {}

void Coverage::clear(const Scene& scene) {
  columns_ = scene.depth.width / kCellPx + 1;
  rows_ = scene.depth.height / kCellPx + 1;
  std::fill_n(buffers_.cells.begin(), columns_ * rows_, std::uint16_t{0});
  owner_count_ = 0;
}

template <class Visit>
void Coverage::visit_cells(const PoseContext& context, const Hypothesis& h, Visit&& visit) const {
  const ObjectModel& model = context.models[h.candidate.model];
  const Scene& scene = context.scene;
  const Viewpoint& view = nearest_viewpoint(model, scene.kernels, h.T_cam_centre);
  simd::SurfaceLook look;
  scene.kernels.look_at_surface(model.surface(view), pose_f(h.T_cam_centre), scene.depth_map, look);
  // What lies on a thin part does not belong to the one below.
  const auto on_surface_mm =
      static_cast<float>(Tolerances(model, scene, h.T_cam_centre).on_surface_mm);
  const int stride = scene.depth_map.stride;
  for (std::uint32_t i = 0; i < view.surface_count; ++i) {
    const int pixel = look.pixel[i];
    if (pixel < 0 || (scene.with_depth && !(std::fabs(look.residual_mm[i]) < on_surface_mm)))
      continue;
    visit(pixel % stride / kCellPx, pixel / stride / kCellPx);
  }
}

std::span<int> Coverage::votes_of(int thread) const {
  const std::size_t each = buffers_.owners.size() + 1;
  return buffers_.votes.subspan(static_cast<std::size_t>(thread) * each, owner_count_ + 1);
}

Coverage::Covered Coverage::covered(const PoseContext& context, const Hypothesis& h,
                                    int thread) const {
  const std::span<int> votes = votes_of(thread);
  std::fill(votes.begin(), votes.end(), 0);
  int total = 0;
  visit_cells(context, h, [&](int x, int y) {
    ++total;
    ++votes[buffers_.cells[static_cast<std::size_t>(y * columns_ + x)]];
  });
  if (total == votes[0]) return {};
  const auto most = std::max_element(votes.begin() + 1, votes.end());
  return {static_cast<double>(total - votes[0]) / total,
          buffers_.owners[static_cast<std::size_t>(most - votes.begin() - 1)]};
}

bool Coverage::add(const PoseContext& context, Hypothesis& h) {
  if (owner_count_ == buffers_.owners.size()) return false;
  buffers_.owners[owner_count_++] = &h;
  const auto owner = static_cast<std::uint16_t>(owner_count_);
  visit_cells(context, h, [&](int cx, int cy) {
    for (int y = std::max(0, cy - 1); y <= std::min(rows_ - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x) {
        std::uint16_t& cell = buffers_.cells[static_cast<std::size_t>(y * columns_ + x)];
        if (cell == 0) cell = owner;
      }
    }
  });
  return true;
}

}  // namespace binpick
