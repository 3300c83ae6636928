// The diameter of a point set without looking at all pairs.
#include <algorithm>
#include <cmath>

#include "binpick/train/mesh.hpp"

namespace binpick::train {
namespace {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr Eigen::Index kAllPairsMax = 3000;
// So many directions on a half sphere leave no direction farther than 0.042 rad from one of them.
// Along the nearest to the diameter the extremes are then at least cos(0.042) of it apart: 0.9991.
constexpr int kDirections = 2000;

struct Pair {
  Eigen::Index a = 0, b = 0;
  double distance_mm = 0;
};

// Walks from point `a` to the farthest one, and on from there, as long as the distance grows.
Pair ascend(const Points& points, Eigen::Index a) {
  Pair best{a, a, 0};
  for (;;) {
    Eigen::Index b = 0;
    const double square = (points.rowwise() - points.row(a)).rowwise().squaredNorm().maxCoeff(&b);
    if (!(std::sqrt(square) > best.distance_mm)) return best;
    best = {a, b, std::sqrt(square)};
    a = b;
  }
}

// A pair that contains a point at distance r from the middle is at most r + r_max apart: points
// that cannot beat `reached_mm` are left out.
Points candidates(const Points& points, double reached_mm) {
  const Eigen::RowVector3d middle =
      0.5 * (points.colwise().minCoeff() + points.colwise().maxCoeff());
  const Eigen::VectorXd radius = (points.rowwise() - middle).rowwise().norm();
  const double radius_min = reached_mm - radius.maxCoeff();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (radius[i] >= radius_min * (1 - 1e-12)) kept.push_back(i);
  }
  return points(kept, Eigen::all);
}

double largest_of_all_pairs(const Points& points) {
  double square = 0;
  for (Eigen::Index i = 0; i + 1 < points.rows(); ++i) {
    const auto rest = points.bottomRows(points.rows() - i - 1);
    square = std::max(square, (rest.rowwise() - points.row(i)).rowwise().squaredNorm().maxCoeff());
  }
  return std::sqrt(square);
}

// Extremes along a Fibonacci lattice on the half sphere; the best of them are improved at the end.
double largest_by_directions(const Points& points) {
  Pair best;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections;
    const double around = 2.399963229728653 * i;  // the golden angle
    const double r = std::sqrt(1 - z * z);
    const Vec3 direction(r * std::cos(around), r * std::sin(around), z);
    const Eigen::VectorXd along = points * direction;
    Pair pair;
    along.minCoeff(&pair.a);
    along.maxCoeff(&pair.b);
    pair.distance_mm = (points.row(pair.a) - points.row(pair.b)).norm();
    if (pair.distance_mm > best.distance_mm) best = pair;
  }
  return std::max(best.distance_mm, ascend(points, best.a).distance_mm);
}

}  // namespace

MeshBounds mesh_bounds(const Mesh& mesh) {
  MeshBounds bounds{Vec3::Zero(), Vec3::Zero(), 0};
  if (mesh.vertices_mm.empty()) return bounds;
  Points points(static_cast<Eigen::Index>(mesh.vertices_mm.size()), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points.row(i) = mesh.vertices_mm[static_cast<std::size_t>(i)].cast<double>().transpose();
  }
  bounds.min_mm = points.colwise().minCoeff().transpose();
  bounds.max_mm = points.colwise().maxCoeff().transpose();

  double reached_mm = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Index start = 0;
    points.col(axis).minCoeff(&start);
    reached_mm = std::max(reached_mm, ascend(points, start).distance_mm);
  }
  const Points rest = candidates(points, reached_mm);
  const double rest_mm =
      rest.rows() <= kAllPairsMax ? largest_of_all_pairs(rest) : largest_by_directions(rest);
  bounds.diameter_mm = std::max(reached_mm, rest_mm);
  return bounds;
}

}  // namespace binpick::train
