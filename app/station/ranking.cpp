#include "station/ranking.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace binpick::app {
namespace {

// Larger is better.
double merit(const Detection& d, Ranking ranking, const Pose& T_ref_cam, bool in_base) {
  switch (ranking) {
    case Ranking::kScore:
      break;
    case Ranking::kNearCamera:
      return -d.T_cam_obj.t_mm.z();
    case Ranking::kHighBase:
      return in_base ? (T_ref_cam * d.T_cam_obj.t_mm).z() : -d.T_cam_obj.t_mm.z();
  }
  return d.score;
}

}  // namespace

int rank_picks(std::span<const Detection> detections, const Recipe& recipe, Ranking ranking,
               const Pose& T_ref_cam, bool in_base, int limit, std::span<int> order,
               std::span<Pick> picks) {
  const std::size_t count = std::min(detections.size(), order.size());
  std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), 0);
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), [&](int a, int b) {
    const Detection& x = detections[static_cast<std::size_t>(a)];
    const Detection& y = detections[static_cast<std::size_t>(b)];
    const auto key = [&](const Detection& d, int index) {
      return std::tuple(-merit(d, ranking, T_ref_cam, in_base), -d.score, index);
    };
    return key(x, a) < key(y, b);
  });
  const std::size_t given =
      std::min({count, picks.size(), static_cast<std::size_t>(std::max(0, limit))});
  for (std::size_t i = 0; i < given; ++i) {
    const Detection& d = detections[static_cast<std::size_t>(order[i])];
    const auto in_recipe = std::find(recipe.models.begin(), recipe.models.end(), d.model_index);
    picks[i] = {T_ref_cam * d.T_cam_obj * recipe.T_obj_pick,
                d.score,
                d.symmetric,
                pose_ambiguous(d),
                d.visible_fraction,
                d.depth_residual_mm,
                static_cast<int>(in_recipe - recipe.models.begin())};
  }
  return static_cast<int>(given);
}

}  // namespace binpick::app
