#include "train/view_reduction.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "train/shell_points.hpp"

namespace binpick::train {
namespace {

// So many directions for each viewpoint that those at its rim are not missed.
constexpr int kDirectionsPerViewpoint = 40;

struct Orbits {
  std::vector<Mat3> turns;  // the identity first
  std::vector<Vec3> axes;
  Vec3 front;  // nearly +z, but equally far from no two equivalent directions

  explicit Orbits(const FoundSymmetry& symmetry)
      : turns{Mat3::Identity()}, front(Vec3(0.0063, 0.0078, 1).normalized()) {
    for (const SymmetryTurn& t : symmetry.turns) {
      if (t.kind == SymmetryKind::kExact) turns.push_back(move_of(t).R);
    }
    for (const SymmetryAxis& a : symmetry.axes) {
      if (a.kind == SymmetryKind::kExact)
        axes.push_back(Eigen::Map<const Eigen::Vector3f>(a.axis).cast<double>());
    }
  }

  // Of all directions about the axis the one nearest to the front.
  Vec3 foremost_about(const Vec3& axis, const Vec3& direction) const {
    const double along = axis.dot(direction);
    const Vec3 across = (front - front.dot(axis) * axis).normalized();
    return along * axis + std::sqrt(std::max(0.0, 1 - along * along)) * across;
  }

  Vec3 foremost(const Vec3& direction) const {
    if (axes.size() > 1) return front;
    Vec3 best = direction;
    for (const Mat3& R : turns) {
      Vec3 d = R * direction;
      if (!axes.empty()) d = foremost_about(axes.front(), d);
      if (d.dot(front) > best.dot(front)) best = d;
    }
    return best;
  }
};

}  // namespace

std::vector<char> needed_viewpoints(const std::vector<Vec3>& viewpoints, double tilt_max_deg,
                                    const FoundSymmetry& symmetry) {
  const Orbits orbits(symmetry);
  if (orbits.turns.size() == 1 && orbits.axes.empty())
    return std::vector<char>(viewpoints.size(), 1);
  std::vector<char> needed(viewpoints.size(), 0);
  const double limit = std::cos(std::min(180.0, tilt_max_deg) * kDegree) - 1e-12;
  for (const Vec3& direction :
       even_directions(kDirectionsPerViewpoint * static_cast<int>(viewpoints.size()))) {
    if (direction.z() < limit) continue;
    const Vec3 d = orbits.foremost(direction);
    std::size_t nearest = 0;
    for (std::size_t v = 1; v < viewpoints.size(); ++v) {
      if (viewpoints[v].dot(d) > viewpoints[nearest].dot(d)) nearest = v;
    }
    needed[nearest] = 1;
  }
  return needed;
}

}  // namespace binpick::train
