#include "train/icosphere.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace binpick::train {
namespace {

using Faces = std::vector<std::array<int, 3>>;

void add_icosahedron(std::vector<Vec3>& vertices, Faces& faces) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (const Vec3& v : {Vec3(-1, g, 0), Vec3(1, g, 0), Vec3(-1, -g, 0), Vec3(1, -g, 0),
                        Vec3(0, -1, g), Vec3(0, 1, g), Vec3(0, -1, -g), Vec3(0, 1, -g),
                        Vec3(g, 0, -1), Vec3(g, 0, 1), Vec3(-g, 0, -1), Vec3(-g, 0, 1)}) {
    vertices.push_back(v.normalized());
  }
  faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
}

std::vector<std::array<int, 2>> edges_of(const Faces& faces) {
  std::map<std::pair<int, int>, int> seen;
  std::vector<std::array<int, 2>> edges;
  for (const auto& f : faces) {
    for (int k = 0; k < 3; ++k) {
      const int a = std::min(f[k], f[(k + 1) % 3]), b = std::max(f[k], f[(k + 1) % 3]);
      if (seen.emplace(std::pair{a, b}, static_cast<int>(edges.size())).second)
        edges.push_back({a, b});
    }
  }
  return edges;
}

}  // namespace

Icosphere make_icosphere(int subdivisions) {
  Icosphere sphere;
  Faces faces;
  add_icosahedron(sphere.vertices, faces);
  sphere.counts.push_back(static_cast<int>(sphere.vertices.size()));
  for (int s = 1; s < subdivisions; ++s) {
    const auto edges = edges_of(faces);
    std::map<std::pair<int, int>, int> midpoint;
    for (const auto& e : edges) {
      midpoint[{e[0], e[1]}] = static_cast<int>(sphere.vertices.size());
      sphere.vertices.push_back((sphere.vertices[e[0]] + sphere.vertices[e[1]]).normalized());
    }
    auto mid = [&](int a, int b) { return midpoint.at({std::min(a, b), std::max(a, b)}); };
    Faces finer;
    for (const auto& f : faces) {
      const int m0 = mid(f[0], f[1]), m1 = mid(f[1], f[2]), m2 = mid(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], m0, m2}, {f[1], m1, m0}, {f[2], m2, m1}, {m0, m1, m2}});
    }
    faces = std::move(finer);
    sphere.edges.push_back(edges);
    sphere.counts.push_back(static_cast<int>(sphere.vertices.size()));
  }
  return sphere;
}

std::vector<int> balanced_parents(const Icosphere& sphere, int s) {
  const auto& edges = sphere.edges.at(s);
  const int vertex_count = sphere.counts[s];
  std::vector<int> parent(sphere.counts[s + 1]);
  for (int v = 0; v < vertex_count; ++v) parent[v] = v;

  // Walking an Euler circuit leaves each vertex as often as it enters it. Give each edge to the
  // vertex that it leaves: a vertex of degree 6 gets 3 midpoints, one of degree 5 gets 2 or 3. A
  // hub joined to the odd vertices makes the circuit exist.
  const int hub = vertex_count;
  std::vector<std::array<int, 2>> graph = edges;
  std::vector<int> degree(vertex_count + 1, 0);
  for (const auto& e : edges) ++degree[e[0]], ++degree[e[1]];
  for (int v = 0; v < vertex_count; ++v) {
    if (degree[v] % 2 == 1) graph.push_back({v, hub});
  }
  std::vector<std::vector<int>> incident(vertex_count + 1);
  for (int e = 0; e < static_cast<int>(graph.size()); ++e) {
    incident[graph[e][0]].push_back(e);
    incident[graph[e][1]].push_back(e);
  }
  std::vector<char> walked(graph.size(), 0);
  for (int start = vertex_count; start >= 0; --start) {  // every walk from a vertex returns to it
    while (true) {
      int v = start;
      bool moved = false;
      while (!incident[v].empty()) {
        const int e = incident[v].back();
        incident[v].pop_back();
        if (walked[e]) continue;
        walked[e] = 1;
        moved = true;
        if (e < static_cast<int>(edges.size())) parent[vertex_count + e] = v;
        v = graph[e][0] == v ? graph[e][1] : graph[e][0];
      }
      if (!moved) break;
    }
  }
  return parent;
}

}  // namespace binpick::train
