#include "simulation/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

using Edge = std::pair<int, int>;

// Turns the triangles so that neighbours run through their common edge in opposite directions.
void orient_consistently(TriangleMesh& mesh) {
  std::map<Edge, std::vector<int>> users;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles[t][k];
      const int b = mesh.triangles[t][(k + 1) % 3];
      users[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  }
  std::vector<bool> done(mesh.triangles.size(), false);
  std::vector<int> open;
  for (int start = 0; start < static_cast<int>(mesh.triangles.size()); ++start) {
    if (done[start]) continue;
    done[start] = true;
    open.push_back(start);
    while (!open.empty()) {
      const Triangle here = mesh.triangles[open.back()];
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int a = here[k];
        const int b = here[(k + 1) % 3];
        for (int t : users[{std::min(a, b), std::max(a, b)}]) {
          if (done[t]) continue;
          Triangle& other = mesh.triangles[t];
          for (int j = 0; j < 3; ++j) {
            if (other[j] == a && other[(j + 1) % 3] == b) {
              std::swap(other[0], other[1]);
              break;
            }
          }
          done[t] = true;
          open.push_back(t);
        }
      }
    }
  }
}

}  // namespace

int TriangleMesh::add_vertex(const Eigen::Vector3d& p) {
  vertices.push_back(p);
  return static_cast<int>(vertices.size()) - 1;
}

Bounds bounds(const TriangleMesh& mesh) {
  Bounds box{Eigen::Vector3d::Constant(1e300), Eigen::Vector3d::Constant(-1e300)};
  for (const auto& v : mesh.vertices) {
    box.min = box.min.cwiseMin(v);
    box.max = box.max.cwiseMax(v);
  }
  return box;
}

double signed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    sum += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  }
  return sum / 6;
}

double diameter(const TriangleMesh& mesh) {
  double largest = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      largest = std::max(largest, (mesh.vertices[i] - mesh.vertices[j]).squaredNorm());
    }
  }
  return std::sqrt(largest);
}

bool is_closed(const TriangleMesh& mesh) {
  std::map<Edge, int> count;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++count[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, uses] : count) {
    const auto back = count.find({edge.second, edge.first});
    if (uses != 1 || back == count.end() || back->second != 1) return false;
  }
  return !mesh.triangles.empty();
}

TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::map<std::array<std::int64_t, 3>, int> index_of;
  std::vector<int> moved;
  for (const auto& v : mesh.vertices) {
    std::array<std::int64_t, 3> key{};
    for (int k = 0; k < 3; ++k) key[k] = std::llround(v[k] * 1e5);
    const auto [at, fresh] = index_of.try_emplace(key, static_cast<int>(out.vertices.size()));
    if (fresh) out.vertices.push_back(v);
    moved.push_back(at->second);
  }
  for (const auto& t : mesh.triangles) {
    const int a = moved[t[0]];
    const int b = moved[t[1]];
    const int c = moved[t[2]];
    if (a != b && b != c && c != a) out.add_triangle(a, b, c);
  }
  return out;
}

TriangleMesh cleaned(const TriangleMesh& mesh) {
  TriangleMesh out = welded(mesh);
  orient_consistently(out);
  if (signed_volume(out) < 0) {
    for (auto& t : out.triangles) std::swap(t[0], t[1]);
  }
  const Bounds box = bounds(out);
  const Eigen::Vector3d centre = (box.min + box.max) / 2;
  for (auto& v : out.vertices) v -= centre;
  return out;
}

std::vector<std::array<Eigen::Vector3f, 3>> corner_normals(const TriangleMesh& mesh,
                                                           double crease_angle_rad) {
  const int count = static_cast<int>(mesh.triangles.size());
  std::vector<Eigen::Vector3d> area_normal(count);
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (int t = 0; t < count; ++t) {
    const Triangle& tri = mesh.triangles[t];
    area_normal[t] = (mesh.vertices[tri[1]] - mesh.vertices[tri[0]])
                         .cross(mesh.vertices[tri[2]] - mesh.vertices[tri[0]]);
    for (int v : tri) around[v].push_back(t);
  }
  std::vector<std::array<Eigen::Vector3f, 3>> normals(count);
  const double cos_min = std::cos(crease_angle_rad);
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3d own = area_normal[t].normalized();
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int other : around[mesh.triangles[t][k]]) {
        const double length = area_normal[other].norm();
        if (area_normal[other].dot(own) >= cos_min * length) sum += area_normal[other];
      }
      normals[t][k] = sum.normalized().cast<float>();
    }
  }
  return normals;
}

double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  double angle = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]] - point;
    const Eigen::Vector3d b = mesh.vertices[t[1]] - point;
    const Eigen::Vector3d c = mesh.vertices[t[2]] - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    angle += 2 * std::atan2(a.dot(b.cross(c)), below);
  }
  return angle / (4 * kPi);
}

}  // namespace binpick::simulation
