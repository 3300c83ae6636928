#include "simulation/simplified_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

namespace binpick::simulation {
namespace {

TriangleMesh clustered(const TriangleMesh& mesh, double cell_mm) {
  const Bounds box = bounds(mesh);
  std::map<std::array<std::int64_t, 3>, int> index_of;
  std::vector<int> moved, members;
  TriangleMesh out;
  for (const auto& v : mesh.vertices) {
    std::array<std::int64_t, 3> cell{};
    for (int k = 0; k < 3; ++k) {
      cell[static_cast<std::size_t>(k)] = std::llround((v[k] - box.min[k]) / cell_mm);
    }
    const auto [at, fresh] = index_of.try_emplace(cell, static_cast<int>(out.vertices.size()));
    if (fresh) {
      out.vertices.push_back(Eigen::Vector3d::Zero());
      members.push_back(0);
    }
    const auto i = static_cast<std::size_t>(at->second);
    out.vertices[i] += v;
    ++members[i];
    moved.push_back(at->second);
  }
  for (std::size_t i = 0; i < out.vertices.size(); ++i) out.vertices[i] /= members[i];
  std::set<Triangle> seen;
  for (const Triangle& t : mesh.triangles) {
    const auto to = [&](int corner) { return moved[static_cast<std::size_t>(t[corner])]; };
    Triangle turned = {to(0), to(1), to(2)};
    if (turned[0] == turned[1] || turned[1] == turned[2] || turned[2] == turned[0]) continue;
    std::rotate(turned.begin(), std::min_element(turned.begin(), turned.end()), turned.end());
    if (seen.insert(turned).second) out.triangles.push_back(turned);
  }
  return out;
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t triangles_max) {
  if (mesh.triangles.size() <= triangles_max) return mesh;
  const Bounds box = bounds(mesh);
  TriangleMesh out;
  // From cells far finer than what any sensor sees.
  for (double cell_mm = (box.max - box.min).norm() / 1000;; cell_mm *= 1.25) {
    out = clustered(mesh, cell_mm);
    if (out.triangles.size() <= triangles_max) return out;
  }
}

}  // namespace binpick::simulation
