#include "solid_builder.hpp"

namespace binpick::simulation {

void SolidBuilder::add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const int ia = mesh_.add_vertex(a);
  const int ib = mesh_.add_vertex(b);
  const int ic = mesh_.add_vertex(c);
  const int id = mesh_.add_vertex(d);
  mesh_.add_triangle(ia, ib, ic);
  mesh_.add_triangle(ia, ic, id);
}

void SolidBuilder::add_wall(const Ring& from, const Ring& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t j = (i + 1) % from.size();
    add_quad(from[i], from[j], to[j], to[i]);
  }
}

void SolidBuilder::add_grid(const std::vector<Ring>& rows) {
  for (std::size_t r = 0; r + 1 < rows.size(); ++r) {
    for (std::size_t i = 0; i + 1 < rows[r].size(); ++i) {
      add_quad(rows[r][i], rows[r][i + 1], rows[r + 1][i + 1], rows[r + 1][i]);
    }
  }
}

void SolidBuilder::add_face(const Region& region,
                            const std::function<Eigen::Vector3d(Eigen::Vector2d)>& lift) {
  const int first = static_cast<int>(mesh_.vertices.size());
  for (const auto& p : region.outer) mesh_.add_vertex(lift(p));
  for (const auto& hole : region.holes) {
    for (const auto& p : hole) mesh_.add_vertex(lift(p));
  }
  for (const auto& t : triangulated(region)) {
    mesh_.add_triangle(first + t[0], first + t[1], first + t[2]);
  }
}

void SolidBuilder::add_face(const Region& region, double z) {
  add_face(region, [z](Eigen::Vector2d p) { return Eigen::Vector3d(p.x(), p.y(), z); });
}

Ring at_height(const Loop& loop, double z) {
  Ring ring;
  for (const auto& p : loop) ring.emplace_back(p.x(), p.y(), z);
  return ring;
}

}  // namespace binpick::simulation
