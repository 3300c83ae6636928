// Nearest points and obstructed rays on a triangle mesh: a tree of boxes. Orientation of triangles
// does not matter, the mesh need not be closed. Immutable once made: thread-safe.
#pragma once

#include <vector>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

class MeshTree {
 public:
  explicit MeshTree(const Mesh& mesh);

  struct Nearest {
    double distance_mm = 0;
    int triangle = -1;  // an index of this tree's own; -1: nothing within the limit
    Vec3 point_mm = Vec3::Zero();
  };
  // The nearest point of the surface that is less than limit_mm away.
  Nearest nearest(const Vec3& from_mm, double limit_mm) const;

  // Whether a ray meets the surface further than `skip_mm` from its start.
  bool blocked(const Vec3& from_mm, const Vec3& direction, double skip_mm) const;

  const Vec3& normal(int triangle) const { return facets_[static_cast<std::size_t>(triangle)].n; }

 private:
  struct Facet {
    Vec3 a, ab, ac, n;  // n: unit
  };
  struct Node {
    Vec3 min_mm, max_mm;
    int first = 0, count = 0;  // facets of a leaf
    int right = -1;            // of an inner node; its left child is the next node
  };
  int add_node(std::vector<int>& order, const std::vector<Vec3>& centres,
               const std::vector<Facet>& facets, int first, int end);

  std::vector<Facet> facets_;  // in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace binpick::train
