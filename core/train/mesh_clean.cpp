#include "mesh_clean.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// A triangle lower than this share of its longest side is a line, within the precision of a float.
constexpr double kFlatness = 1e-7;

std::string counted(std::size_t count, const std::string& singular, const std::string& plural) {
  return std::to_string(count) + " " + (count == 1 ? singular : plural);
}

Vec3 corner(const Mesh& mesh, std::uint32_t index) {
  return mesh.vertices_mm[index].cast<double>();
}

void check_vertices(const Mesh& mesh) {
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      if (index >= mesh.vertices_mm.size()) {
        throw ImportError("a triangle refers to vertex " + std::to_string(index) + " of " +
                          std::to_string(mesh.vertices_mm.size()));
      }
      if (!mesh.vertices_mm[index].allFinite()) {
        throw ImportError("vertex " + std::to_string(index) + " is not a finite number");
      }
    }
  }
}

// Keeps the vertices that a triangle uses, in the order of their first use.
std::size_t drop_unused_vertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFF;
  std::vector<std::uint32_t> renamed(mesh.vertices_mm.size(), kUnused);
  std::vector<Eigen::Vector3f> used;
  used.reserve(mesh.vertices_mm.size());
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) {
      if (renamed[index] == kUnused) {
        renamed[index] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.vertices_mm[index]);
      }
      index = renamed[index];
    }
  }
  const std::size_t dropped_count = mesh.vertices_mm.size() - used.size();
  mesh.vertices_mm = std::move(used);
  return dropped_count;
}

// Of equal vertices the first one stays in use. Equal means the same floats: files that repeat a
// vertex for each triangle repeat its digits.
void merge_equal_vertices(Mesh& mesh) {
  const auto& vertices = mesh.vertices_mm;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3f &p = vertices[a], &q = vertices[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  };
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), before);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool equal = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = equal ? first[order[i - 1]] : order[i];
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& index : triangle) index = first[index];
  }
}

bool has_area(const Mesh& mesh, const Triangle& triangle) {
  const Vec3 a = corner(mesh, triangle[0]);
  const Vec3 ab = corner(mesh, triangle[1]) - a, ac = corner(mesh, triangle[2]) - a;
  const double side_square =
      std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return side_square > 0 && ab.cross(ac).norm() > kFlatness * side_square;
}

std::size_t drop_flat_triangles(Mesh& mesh) {
  return std::erase_if(mesh.triangles, [&](const Triangle& t) { return !has_area(mesh, t); });
}

// Two triangles with the same three corners are one, whichever way they run: of a sheet that is
// drawn from both sides the first side stays.
std::size_t drop_duplicate_triangles(Mesh& mesh) {
  struct Key {
    Triangle corners;
    std::uint32_t index;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(mesh.triangles.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    keys[i] = {mesh.triangles[i], i};
    std::sort(keys[i].corners.begin(), keys[i].corners.end());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<bool> duplicate(keys.size(), false);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    duplicate[keys[i].index] = keys[i].corners == keys[i - 1].corners;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!duplicate[i]) mesh.triangles[kept++] = mesh.triangles[i];
  }
  const std::size_t dropped_count = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  return dropped_count;
}

struct EdgeCounts {
  std::size_t open = 0;          // one triangle only
  std::size_t crowded = 0;       // more than two
  std::size_t inconsistent = 0;  // two that run along it in the same direction
};

EdgeCounts count_edges(const Mesh& mesh) {
  struct Edge {
    std::uint32_t low, high;
    bool rising;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    while (next < edges.size() && edges[next].low == edges[i].low &&
           edges[next].high == edges[i].high) {
      ++next;
    }
    counts.open += next - i == 1;
    counts.crowded += next - i > 2;
    counts.inconsistent += next - i == 2 && edges[i].rising == edges[i + 1].rising;
  }
  return counts;
}

// Six times the volume inside, negative when the triangles run clockwise seen from outside.
double signed_volume(const Mesh& mesh) {
  const Vec3 origin = corner(mesh, mesh.triangles[0][0]);
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = corner(mesh, t[0]) - origin, b = corner(mesh, t[1]) - origin;
    volume += a.cross(b).dot(corner(mesh, t[2]) - origin);
  }
  return volume;
}

void judge_surface(Mesh& mesh, std::vector<std::string>& notes) {
  const EdgeCounts edges = count_edges(mesh);
  if (edges.open > 0) {
    notes.push_back("The surface is not closed: " + counted(edges.open, "edge has", "edges have") +
                    " a triangle on one side only.");
  }
  if (edges.crowded > 0) {
    notes.push_back("The surface meets itself: " +
                    counted(edges.crowded, "edge has", "edges have") + " more than two triangles.");
  }
  if (edges.inconsistent > 0) {
    notes.push_back("Inside and outside are mixed up: the triangles along " +
                    counted(edges.inconsistent, "edge", "edges") + " run in opposite senses.");
  }
  const bool closed = edges.open + edges.crowded + edges.inconsistent == 0;
  if (closed && signed_volume(mesh) < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    notes.push_back("The surface was inside out; all triangles were turned around.");
  }
}

}  // namespace

Mesh clean_mesh(Mesh mesh, std::vector<std::string>& notes) {
  if (mesh.triangles.empty()) throw ImportError("there are no triangles in it");
  check_vertices(mesh);
  const std::size_t unused_count = drop_unused_vertices(mesh);
  merge_equal_vertices(mesh);
  const std::size_t flat_count = drop_flat_triangles(mesh);
  if (mesh.triangles.empty()) throw ImportError("zero extent: none of its triangles has an area");
  const std::size_t duplicate_count = drop_duplicate_triangles(mesh);
  drop_unused_vertices(mesh);

  if (unused_count > 0) {
    notes.push_back(counted(unused_count, "vertex", "vertices") + " in no triangle left out.");
  }
  if (flat_count > 0) {
    notes.push_back(counted(flat_count, "triangle", "triangles") + " without area left out.");
  }
  if (duplicate_count > 0) {
    notes.push_back(counted(duplicate_count, "duplicate triangle", "duplicate triangles") +
                    " left out.");
  }
  judge_surface(mesh, notes);
  return mesh;
}

}  // namespace binpick::train
