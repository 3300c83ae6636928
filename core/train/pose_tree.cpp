#include "train/pose_tree.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "binpick/model/object_model.hpp"
#include "train/icosphere.hpp"
#include "train/view_reduction.hpp"

namespace binpick::train {
namespace {

// Which vertices of each subdivision are wanted: leaves within the tilt limit, as far as the part's
// symmetry needs them, and their ancestors.
std::vector<std::vector<char>> wanted_vertices(const Icosphere& sphere,
                                               const std::vector<std::vector<int>>& parents,
                                               double tilt_max_deg, const FoundSymmetry& symmetry) {
  const int depths = static_cast<int>(sphere.counts.size());
  std::vector<std::vector<char>> wanted(depths);
  for (int d = 0; d < depths; ++d) wanted[d].assign(sphere.counts[d], 0);
  // Half the spacing of the leaves is added, so that every pose inside the limit has a leaf near
  // it.
  const double spacing_deg = 63.4 / (1 << (depths - 1));
  const double limit_rad = std::min(180.0, tilt_max_deg + spacing_deg / 2) * kDegree;
  std::vector<int> within;
  std::vector<Vec3> directions;
  for (int v = 0; v < sphere.counts.back(); ++v) {
    if (sphere.vertices[v].z() < std::cos(limit_rad) - 1e-12) continue;
    within.push_back(v);
    directions.push_back(sphere.vertices[v]);
  }
  const std::vector<char> needed = needed_viewpoints(directions, tilt_max_deg, symmetry);
  for (std::size_t i = 0; i < within.size(); ++i) {
    if (!needed[i]) continue;
    int at = within[i];
    wanted[depths - 1][at] = 1;
    for (int d = depths - 1; d > 0; --d) {
      at = parents[d - 1][at];
      wanted[d - 1][at] = 1;
    }
  }
  return wanted;
}

Mat3 looking_from(const Vec3& direction) {
  const Vec3 z = -direction;
  const Vec3 up = std::abs(z.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 x = up.cross(z).normalized();
  Mat3 R;
  R.row(0) = x.transpose();
  R.row(1) = z.cross(x).transpose();
  R.row(2) = z.transpose();
  return R;
}

// Steps of equal ratio, since distance is scale; the interval is that of the middle of the range.
int leaf_distance_count(const TrainOptions& options) {
  const double middle_mm = std::sqrt(options.distance_min_mm * options.distance_max_mm);
  const double steps = std::log(options.distance_max_mm / options.distance_min_mm) /
                       std::log1p(options.distance_interval_mm / middle_mm);
  return std::clamp(static_cast<int>(std::lround(steps)), 1, kModelDistancesMax);
}

}  // namespace

double roll_centre_rad(int roll, int roll_count) {
  return (roll + 0.5) * 2 * kPi / roll_count;
}

Mat3 rotation_z(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Mat3 R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R;
}

PoseTree make_pose_tree(const TrainOptions& options, const FoundSymmetry& symmetry) {
  const int depths = options.tree_depths;
  const Icosphere sphere = make_icosphere(depths);
  std::vector<std::vector<int>> parents;
  for (int s = 0; s + 1 < depths; ++s) parents.push_back(balanced_parents(sphere, s));
  const auto wanted = wanted_vertices(sphere, parents, options.tilt_max_deg, symmetry);

  PoseTree tree;
  tree.depths.resize(depths);
  const int halvings = 1 << (depths - 1);
  const int root_rolls =
      std::max(1, static_cast<int>(std::lround(360 / options.roll_interval_deg / halvings)));
  const int leaf_distances = leaf_distance_count(options);

  std::vector<int> vertex_of;  // of the depth just built: tree index -> sphere vertex
  for (int v = 0; v < sphere.counts[0]; ++v) {
    if (!wanted[0][v]) continue;
    tree.depths[0].viewpoints.push_back(
        {sphere.vertices[v], looking_from(sphere.vertices[v]), -1, 0, 0});
    vertex_of.push_back(v);
  }
  for (int d = 0; d < depths; ++d) {
    TreeLayer& layer = tree.depths[d];
    layer.roll_count = root_rolls << d;
    layer.distance_count = ((leaf_distances - 1) >> (depths - 1 - d)) + 1;
    if (d + 1 == depths) break;
    TreeLayer& below = tree.depths[d + 1];
    std::vector<int> below_vertex_of;
    for (int i = 0; i < static_cast<int>(layer.viewpoints.size()); ++i) {
      TreeViewpoint& view = layer.viewpoints[i];
      view.child_first = static_cast<int>(below.viewpoints.size());
      for (int v = 0; v < sphere.counts[d + 1]; ++v) {
        if (!wanted[d + 1][v] || parents[d][v] != vertex_of[i]) continue;
        const Mat3 turn = rotation_between(view.direction_obj, sphere.vertices[v]);
        below.viewpoints.push_back(
            {sphere.vertices[v], orthonormalized(view.R_view_obj * turn.transpose()), i, 0, 0});
        below_vertex_of.push_back(v);
      }
      view.child_count = static_cast<int>(below.viewpoints.size()) - view.child_first;
    }
    vertex_of = std::move(below_vertex_of);
  }
  return tree;
}

}  // namespace binpick::train
