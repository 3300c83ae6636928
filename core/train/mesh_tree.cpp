#include "train/mesh_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace binpick::train {
namespace {

constexpr int kFacetsPerLeaf = 4;
// Halving two million triangles by count ends far above this.
constexpr int kDepthMax = 64;

double box_distance2(const Vec3& low, const Vec3& high, const Vec3& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

// The point of triangle (a, a + ab, a + ac) nearest to p, by the Voronoi regions of its corners,
// edges and inside.
Vec3 nearest_on_triangle(const Vec3& a, const Vec3& ab, const Vec3& ac, const Vec3& p) {
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = ap - ab;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return a + ab;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = ap - ac;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return a + ac;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return a + ab + w * (ac - ab);
  }
  const double scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

}  // namespace

MeshTree::MeshTree(const Mesh& mesh) {
  std::vector<Facet> facets;
  std::vector<Vec3> centres;
  facets.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]].cast<double>();
    const Vec3 ab = mesh.vertices_mm[t[1]].cast<double>() - a;
    const Vec3 ac = mesh.vertices_mm[t[2]].cast<double>() - a;
    facets.push_back({a, ab, ac, ab.cross(ac).normalized()});
    centres.push_back(a + (ab + ac) / 3);
  }
  if (facets.empty()) return;
  std::vector<int> order(facets.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(facets.size());
  add_node(order, centres, facets, 0, static_cast<int>(order.size()));
  facets_.reserve(facets.size());
  for (const int i : order) facets_.push_back(facets[static_cast<std::size_t>(i)]);
}

int MeshTree::add_node(std::vector<int>& order, const std::vector<Vec3>& centres,
                       const std::vector<Facet>& facets, int first, int end) {
  Node node;
  node.min_mm = Vec3::Constant(std::numeric_limits<double>::infinity());
  node.max_mm = -node.min_mm;
  Vec3 low = node.min_mm, high = node.max_mm;  // of the centres
  for (int i = first; i < end; ++i) {
    const auto at = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
    const Facet& f = facets[at];
    for (const Vec3& corner : {f.a, Vec3(f.a + f.ab), Vec3(f.a + f.ac)}) {
      node.min_mm = node.min_mm.cwiseMin(corner);
      node.max_mm = node.max_mm.cwiseMax(corner);
    }
    low = low.cwiseMin(centres[at]);
    high = high.cwiseMax(centres[at]);
  }
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
  if (end - first <= kFacetsPerLeaf) {
    nodes_.back().first = first;
    nodes_.back().count = end - first;
    return index;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const int middle = first + (end - first) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + end,
                   [&](int a, int b) {
                     const double ca = centres[static_cast<std::size_t>(a)][axis],
                                  cb = centres[static_cast<std::size_t>(b)][axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  add_node(order, centres, facets, first, middle);
  const int right = add_node(order, centres, facets, middle, end);
  nodes_[static_cast<std::size_t>(index)].right = right;
  return index;
}

MeshTree::Nearest MeshTree::nearest(const Vec3& p, double limit_mm) const {
  Nearest best;
  if (nodes_.empty()) return best;
  double best2 = limit_mm * limit_mm;
  int stack[kDepthMax];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int at = stack[--depth];
    const Node& node = nodes_[static_cast<std::size_t>(at)];
    if (box_distance2(node.min_mm, node.max_mm, p) >= best2) continue;
    if (node.right >= 0) {
      const Node &l = nodes_[static_cast<std::size_t>(at) + 1],
                 &r = nodes_[static_cast<std::size_t>(node.right)];
      const bool left_first =
          box_distance2(l.min_mm, l.max_mm, p) <= box_distance2(r.min_mm, r.max_mm, p);
      stack[depth++] = left_first ? node.right : at + 1;
      stack[depth++] = left_first ? at + 1 : node.right;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Facet& f = facets_[static_cast<std::size_t>(i)];
      const Vec3 q = nearest_on_triangle(f.a, f.ab, f.ac, p);
      const double d2 = (q - p).squaredNorm();
      if (d2 >= best2) continue;
      best2 = d2;
      best.triangle = i;
      best.point_mm = q;
    }
  }
  best.distance_mm = best.triangle >= 0 ? std::sqrt(best2) : limit_mm;
  return best;
}

bool MeshTree::blocked(const Vec3& from, const Vec3& direction, double skip_mm) const {
  if (nodes_.empty()) return false;
  const Vec3 inverse = direction.cwiseInverse();
  int stack[kDepthMax];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int at = stack[--depth];
    const Node& node = nodes_[static_cast<std::size_t>(at)];
    const Vec3 t0 = (node.min_mm - from).cwiseProduct(inverse);
    const Vec3 t1 = (node.max_mm - from).cwiseProduct(inverse);
    const double enter = t0.cwiseMin(t1).maxCoeff(), leave = t0.cwiseMax(t1).minCoeff();
    if (leave < skip_mm || enter > leave + 1e-9) continue;
    if (node.right >= 0) {
      stack[depth++] = node.right;
      stack[depth++] = at + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Facet& f = facets_[static_cast<std::size_t>(i)];
      const Vec3 p = direction.cross(f.ac);
      const double det = f.ab.dot(p);
      if (std::abs(det) < 1e-12) continue;
      const Vec3 s = from - f.a;
      const double u = s.dot(p) / det;
      if (u < 0 || u > 1) continue;
      const Vec3 q = s.cross(f.ab);
      const double v = direction.dot(q) / det;
      if (v < 0 || u + v > 1) continue;
      if (f.ac.dot(q) / det > skip_mm) return true;
    }
  }
  return false;
}

}  // namespace binpick::train
