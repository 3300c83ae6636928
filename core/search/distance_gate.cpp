#include "search/distance_gate.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
namespace {

// A convex part shows its surface about a quarter of its diameter before its centre, give or take.
constexpr double kSurfaceBeforeCentre = 0.25;
constexpr double kSurfaceSpread = 0.35;

}  // namespace

bool DistanceGate::allows(const PyramidLevel& level, int x, int y, int d,
                          int distance_index) const {
  const TreeDepth& depth = model_.depth(d);
  if (depth.distance_count == 1) return true;
  const ModelInfo& info = model_.info();
  const double half_interval = model_.distance_interval_mm(d, distance_index) / 2;
  const double expected =
      model_.distance_mm(d, distance_index) - kSurfaceBeforeCentre * info.diameter_mm;
  const double tolerance = half_interval + kSurfaceSpread * info.diameter_mm;
  bool measured = false;
  for (int v = std::max(0, y - 1); v <= std::min(level.height - 1, y + 2); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(level.width - 1, x + 2); ++u) {
      const double z = static_cast<double>(level.depth_mm[v * level.stride + u]);
      if (!(z > 0)) continue;
      if (std::abs(z - expected) <= tolerance) return true;
      measured = true;
    }
  }
  return !measured;
}

}  // namespace binpick
