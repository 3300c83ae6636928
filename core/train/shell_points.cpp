#include "train/shell_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "binpick/geometry/angle.hpp"
#include "train/random.hpp"

namespace binpick::train {
namespace {

constexpr int kSightLines = 48;
// Rays start this far, as a share of the part's extent, off the face that they leave.
constexpr double kSkipShare = 1e-5;
constexpr std::uint64_t kSeed = 0x5E11;

double fraction(double x) {
  return x - std::floor(x);
}

// What all directions together see of a face at this point: of a face that nothing hides, one side
// is seen from half of them, at a cosine of one half on average.
double seen_weight(const MeshTree& tree, const Vec3& point, const Vec3& normal,
                   const std::vector<Vec3>& directions, double skip_mm) {
  double seen = 0;
  for (const Vec3& d : directions) {
    const double cosine = std::abs(normal.dot(d));
    if (cosine < 0.05) continue;
    if (!tree.blocked(point, d, skip_mm / cosine)) seen += cosine;
  }
  return seen / (0.25 * static_cast<double>(directions.size()));
}

}  // namespace

std::vector<Vec3> even_directions(int count) {
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double turn = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

std::vector<ShellPoint> make_shell_points(const Mesh& mesh, const MeshTree& tree, int count) {
  std::vector<double> area_below;  // of the triangles up to and including this one
  double total = 0;
  const auto corner = [&](std::size_t t, int i) -> Vec3 {
    return mesh.vertices_mm[mesh.triangles[t][static_cast<std::size_t>(i)]].cast<double>();
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    total += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    area_below.push_back(total);
  }
  std::vector<ShellPoint> points;
  if (!(total > 0)) return points;
  const MeshBounds bounds = mesh_bounds(mesh);
  const double skip_mm = kSkipShare * bounds.diameter_mm;
  const std::vector<Vec3> directions = even_directions(kSightLines);
  for (int i = 0; i < count; ++i) {
    // Multiples of the golden ratio leave no gap larger than a few times the average.
    const double area = total * fraction((i + 0.5) * std::numbers::phi);
    const auto it = std::upper_bound(area_below.begin(), area_below.end() - 1, area);
    const auto t = static_cast<std::size_t>(it - area_below.begin());
    const auto index = static_cast<std::uint64_t>(i);
    const double s = std::sqrt(hashed_uniform(kSeed, 2 * index));
    const double r = hashed_uniform(kSeed, 2 * index + 1);
    const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    ShellPoint p;
    p.position_mm = a * (1 - s) + b * (s * (1 - r)) + c * (s * r);
    p.normal = (b - a).cross(c - a).normalized();
    p.weight = seen_weight(tree, p.position_mm, p.normal, directions, skip_mm);
    if (p.weight > 0) points.push_back(p);
  }
  return points;
}

}  // namespace binpick::train
