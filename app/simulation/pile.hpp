// Drops parts into a bin and lets them come to rest.
#pragma once

#include <vector>

#include "binpick/geometry/pose.hpp"
#include "simulation/convex_pieces.hpp"
#include "simulation/random.hpp"

namespace binpick::simulation {

// The inside of the bin, with the origin at the middle of its floor and z upwards; mm.
struct BinSize {
  double length = 256;  // along x
  double width = 147;   // along y
  double height = 58;
  double wall = 7;
};

// What collides: pieces in the coordinates of the part's mesh.
struct CollisionShape {
  std::vector<ConvexPiece> pieces;
  double radius_mm = 0;  // half the diagonal of the bounding box
};

struct PlacedPart {
  std::size_t kind = 0;  // index into the shapes
  Pose T_world_obj;
};

// Drops parts of shapes[kinds[i]] in layers. Parts that end outside the bin are left out.
std::vector<PlacedPart> make_pile(const std::vector<CollisionShape>& shapes,
                                  const std::vector<std::size_t>& kinds, const BinSize& bin,
                                  Rng rng);

}  // namespace binpick::simulation
