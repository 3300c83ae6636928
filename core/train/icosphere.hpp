// Viewpoints: the icosahedron, subdivided by halving its edges (paper section III-B): 12, 42, 162,
// 642 vertices.
#pragma once

#include <array>
#include <vector>

#include "binpick/geometry/pose.hpp"

namespace binpick::train {

struct Icosphere {
  // Vertices of subdivision s are the first counts[s] entries: a subdivision keeps its parent's
  // vertices.
  std::vector<Vec3> vertices;  // unit length
  std::vector<int> counts;
  // edges[s]: the edges of subdivision s; the midpoint of edge e is vertex counts[s] + e.
  std::vector<std::vector<std::array<int, 2>>> edges;
};

// subdivisions = 1 gives the icosahedron alone.
Icosphere make_icosphere(int subdivisions);

// For each vertex of subdivision s + 1 its nearest vertex of subdivision s. A midpoint is as near
// to one end of its edge as to the other: the ties are broken so that each parent gets three or
// four children.
std::vector<int> balanced_parents(const Icosphere& sphere, int s);

}  // namespace binpick::train
