// Points spread evenly over what can be seen of a part from outside. Shells inside the part, and
// the faces along which its solids touch, are in the CAD file but in no image.
#pragma once

#include <vector>

#include "train/mesh_tree.hpp"

namespace binpick::train {

struct ShellPoint {
  Vec3 position_mm;
  Vec3 normal;        // unit; of either sign
  double weight = 0;  // how much of it is seen, averaged over all directions; a plain face has 1
};

// About `count` points, uniform by area, less those that no direction sees. The first n of them
// are spread as evenly as all, whatever n is.
std::vector<ShellPoint> make_shell_points(const Mesh& mesh, const MeshTree& tree, int count);

// `count` directions spread evenly over the sphere: the golden-angle spiral.
std::vector<Vec3> even_directions(int count);

}  // namespace binpick::train
