// The symmetries of a part, from its mesh alone: no annotation, no assumption about the axes of the
// CAD file, its triangulation, or that it is closed. Proper rotations only; colours do not count.
#pragma once

#include <vector>

#include "binpick/model/part_symmetry.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::train {

// Two scales, both bounded by shares of the part's diameter, so that neither a coarse sensor makes
// a part symmetric whose shape is not, nor a fine one tells facets apart.
struct SymmetryTolerance {
  // An exact symmetry moves no visible point further off the surface than this: the random error of
  // one depth value, at least the facets of a circle drawn with 20 corners, at most 1 % of the
  // diameter.
  double exact_mm = 0;
  // Surfaces nearer than this coincide, where similarity is measured: the whole error of a depth
  // value, shape distortion included.
  double similar_mm = 0;
};
SymmetryTolerance symmetry_tolerance(double diameter_mm, double focal_px, double distance_mm);

struct FoundSymmetry {
  std::vector<SymmetryTurn> turns;  // exact ones first, then near ones, most alike first
  std::vector<SymmetryAxis> axes;   // exact ones first
};

// Of what coincides for less than this share of the visible surface nothing is said.
inline constexpr double kNearDifferingMax = 0.45;

// `mesh` is centred on the middle of its bounding box. A second or two on one core.
FoundSymmetry find_symmetry(const Mesh& mesh, double diameter_mm,
                            const SymmetryTolerance& tolerance);

}  // namespace binpick::train
