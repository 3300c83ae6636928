#include "simulation/convex_pieces.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

using Eigen::Vector3d;
using Facet = std::vector<Vector3d>;  // a triangle clipped to a box

// The part of the solid inside a box: its surface there, and the box corners that lie inside.
struct Cell {
  Vector3d min, max;
  std::vector<Facet> facets;
  std::vector<Vector3d> corners;
  double volume = 0;  // of the hull
};

struct Cut {
  double gain = 0;
  Cell low, high;
};

std::vector<Vector3d> all_points(const Cell& cell) {
  std::vector<Vector3d> points = cell.corners;
  for (const auto& facet : cell.facets) points.insert(points.end(), facet.begin(), facet.end());
  return points;
}

Facet clipped(const Facet& facet, int axis, double at, double keep_side) {
  Facet out;
  for (std::size_t i = 0; i < facet.size(); ++i) {
    const Vector3d& a = facet[i];
    const Vector3d& b = facet[(i + 1) % facet.size()];
    const double da = keep_side * (a[axis] - at);
    const double db = keep_side * (b[axis] - at);
    if (da >= 0) out.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.push_back(a + (b - a) * (da / (da - db)));
  }
  return out.size() >= 3 ? out : Facet{};
}

Cell half_of(const Cell& cell, int axis, double at, bool upper,
             const std::vector<Vector3d>& corners_on_plane) {
  Cell half;
  half.min = cell.min;
  half.max = cell.max;
  (upper ? half.min : half.max)[axis] = at;
  const double side = upper ? 1.0 : -1.0;
  for (const auto& facet : cell.facets) {
    Facet part = clipped(facet, axis, at, side);
    if (!part.empty()) half.facets.push_back(std::move(part));
  }
  for (const auto& c : cell.corners) {
    if (side * (c[axis] - at) > 0) half.corners.push_back(c);
  }
  half.corners.insert(half.corners.end(), corners_on_plane.begin(), corners_on_plane.end());
  half.volume = hull_volume(all_points(half));
  return half;
}

// Planes worth trying: where flat faces lie, and an even spread between them.
std::vector<double> candidate_planes(const Cell& cell, int axis) {
  const double low = cell.min[axis];
  const double high = cell.max[axis];
  std::map<long, double> area_at;
  for (const auto& facet : cell.facets) {
    const Vector3d normal = (facet[1] - facet[0]).cross(facet[2] - facet[0]);
    if (std::abs(normal[axis]) > 0.999 * normal.norm()) {
      area_at[std::lround(facet[0][axis] * 100)] += normal.norm() / 2;
    }
  }
  std::vector<std::pair<double, long>> flat;
  for (const auto& [at, area] : area_at) flat.emplace_back(-area, at);
  std::sort(flat.begin(), flat.end());
  if (flat.size() > 5) flat.resize(5);
  std::vector<double> planes;
  for (const auto& [area, at] : flat) planes.push_back(static_cast<double>(at) / 100);
  for (int i = 1; i < 8; ++i) planes.push_back(low + (high - low) * i / 8);
  const double margin = std::max(0.5, 0.02 * (high - low));  // no slivers
  std::erase_if(planes, [&](double p) { return p < low + margin || p > high - margin; });
  return planes;
}

Cut best_cut(const TriangleMesh& mesh, const Cell& cell) {
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    for (double at : candidate_planes(cell, axis)) {
      std::vector<Vector3d> inside;
      for (int k = 0; k < 4; ++k) {
        Vector3d corner = cell.min;
        corner[axis] = at;
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        if ((k & 1) != 0) corner[u] = cell.max[u];
        if ((k & 2) != 0) corner[v] = cell.max[v];
        if (winding_number(mesh, corner) > 0.5) inside.push_back(corner);
      }
      Cell low = half_of(cell, axis, at, false, inside);
      Cell high = half_of(cell, axis, at, true, inside);
      const double gain = cell.volume - low.volume - high.volume;
      if (gain > best.gain) best = {gain, std::move(low), std::move(high)};
    }
  }
  return best;
}

ConvexPiece thinned(const std::vector<Vector3d>& points, int corners_max) {
  btConvexHullComputer hull;
  hull.compute(points[0].data(), sizeof(Vector3d), static_cast<int>(points.size()), 0, 0);
  ConvexPiece corners;
  for (int i = 0; i < hull.vertices.size(); ++i) {
    corners.emplace_back(hull.vertices[i].x(), hull.vertices[i].y(), hull.vertices[i].z());
  }
  if (static_cast<int>(corners.size()) <= corners_max) return corners;
  std::vector<bool> kept(corners.size(), false);
  for (int k = 0; k < corners_max; ++k) {  // the extreme points of evenly spread directions
    const double z = 1 - 2 * (k + 0.5) / corners_max;
    const double turn = kPi * (1 + std::sqrt(5.0)) * k;
    const double r = std::sqrt(1 - z * z);
    const Vector3d direction(r * std::cos(turn), r * std::sin(turn), z);
    std::size_t best = 0;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      if (corners[i].dot(direction) > corners[best].dot(direction)) best = i;
    }
    kept[best] = true;
  }
  ConvexPiece out;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (kept[i]) out.push_back(corners[i]);
  }
  return out;
}

}  // namespace

double hull_volume(const std::vector<Vector3d>& points) {
  if (points.size() < 4) return 0;
  btConvexHullComputer hull;
  hull.compute(points[0].data(), sizeof(Vector3d), static_cast<int>(points.size()), 0, 0);
  if (hull.vertices.size() < 4) return 0;
  const auto at = [&](int i) {
    return Vector3d(hull.vertices[i].x(), hull.vertices[i].y(), hull.vertices[i].z());
  };
  double sum = 0;
  for (int f = 0; f < hull.faces.size(); ++f) {
    const auto* first = &hull.edges[hull.faces[f]];
    const Vector3d origin = at(first->getSourceVertex());
    for (const auto* e = first->getNextEdgeOfFace(); e != first; e = e->getNextEdgeOfFace()) {
      sum += origin.dot(at(e->getSourceVertex()).cross(at(e->getTargetVertex())));
    }
  }
  return std::abs(sum) / 6;
}

std::vector<ConvexPiece> convex_pieces(const TriangleMesh& mesh, const ConvexPiecesParams& params) {
  const Bounds box = bounds(mesh);
  Cell whole{box.min - Vector3d::Constant(0.1), box.max + Vector3d::Constant(0.1), {}, {}, 0};
  for (const auto& t : mesh.triangles) {
    whole.facets.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  whole.volume = hull_volume(all_points(whole));
  const double solid = std::abs(signed_volume(mesh));
  double total = whole.volume;
  std::vector<Cell> cells = {whole};
  std::vector<Cut> cuts;
  cuts.push_back(best_cut(mesh, whole));
  while (static_cast<int>(cells.size()) < params.pieces_max &&
         total > solid * (1 + params.excess_max)) {
    const auto most = std::max_element(cuts.begin(), cuts.end(),
                                       [](const Cut& a, const Cut& b) { return a.gain < b.gain; });
    if (most->gain < 1e-3 * solid) break;
    const auto at = static_cast<std::size_t>(most - cuts.begin());
    const Cut cut = std::move(cuts[at]);
    total -= cut.gain;
    cells[at] = cut.low;
    cells.push_back(cut.high);
    cuts[at] = best_cut(mesh, cut.low);
    cuts.push_back(best_cut(mesh, cut.high));
  }
  std::vector<ConvexPiece> pieces;
  for (const auto& cell : cells) {
    if (cell.volume > 1e-9) pieces.push_back(thinned(all_points(cell), params.corners_max));
  }
  return pieces;
}

}  // namespace binpick::simulation
