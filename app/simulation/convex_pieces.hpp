// Cuts a mesh into convex pieces for collision. The mesh is split by axis-parallel planes, each
// time the one that takes most empty space out of the pieces' hulls, until the hulls hold little
// more than the solid itself.
#pragma once

#include <vector>

#include "simulation/triangle_mesh.hpp"

namespace binpick::simulation {

using ConvexPiece = std::vector<Eigen::Vector3d>;  // corners of a convex hull, mm

struct ConvexPiecesParams {
  int pieces_max = 28;
  double excess_max =
      0.06;              // hull volume beyond the solid's, as a share of it, that is good enough
  int corners_max = 32;  // corners of one hull; more are thinned out
};

std::vector<ConvexPiece> convex_pieces(const TriangleMesh& mesh, const ConvexPiecesParams& params);

double hull_volume(const std::vector<Eigen::Vector3d>& points);

}  // namespace binpick::simulation
