// Puts closed solids together from rings and flat faces. Points are emitted anew for each face and
// merged by cleaned(), so neighbouring faces only have to be given the very same points.
#pragma once

#include <functional>
#include <vector>

#include "polygon.hpp"
#include "simulation/triangle_mesh.hpp"

namespace binpick::simulation {

using Ring = std::vector<Eigen::Vector3d>;

class SolidBuilder {
 public:
  // The strip between two closed rings with equally many points.
  void add_wall(const Ring& from, const Ring& to);
  // The grid between rows of points that are not closed.
  void add_grid(const std::vector<Ring>& rows);
  // A face over a plane region, each point lifted into space.
  void add_face(const Region& region, const std::function<Eigen::Vector3d(Eigen::Vector2d)>& lift);
  // A face at one height.
  void add_face(const Region& region, double z);

  TriangleMesh finish() const { return cleaned(mesh_); }

 private:
  void add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Eigen::Vector3d& d);
  TriangleMesh mesh_;
};

Ring at_height(const Loop& loop, double z);

}  // namespace binpick::simulation
