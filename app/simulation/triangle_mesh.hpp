// A triangle mesh in mm with what a data set has to know of it. Plain values, no hidden state.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace binpick::simulation {

using Triangle = std::array<int, 3>;

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;

  void add_triangle(int a, int b, int c) { triangles.push_back({a, b, c}); }
  int add_vertex(const Eigen::Vector3d& p);
};

struct Bounds {
  Eigen::Vector3d min, max;
};

Bounds bounds(const TriangleMesh& mesh);
double signed_volume(const TriangleMesh& mesh);
double diameter(const TriangleMesh& mesh);  // largest distance between two vertices
// Every edge is used exactly once in each direction.
bool is_closed(const TriangleMesh& mesh);

// Merges vertices closer than 1e-6 mm, drops triangles that collapse, turns all triangles of a
// connected surface the same way and outwards, and moves the centre of the bounding box to 0.
TriangleMesh cleaned(const TriangleMesh& mesh);
// As cleaned, without the move and the turning: for meshes whose origin is given.
TriangleMesh welded(const TriangleMesh& mesh);

// One normal per corner: triangles that meet at less than the angle are shaded smoothly.
std::vector<std::array<Eigen::Vector3f, 3>> corner_normals(const TriangleMesh& mesh,
                                                           double crease_angle_rad);

// How often a ray out of the point leaves the surface, as a winding number: 1 inside, 0 outside,
// and a usable answer for meshes with small holes.
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& point);

}  // namespace binpick::simulation
