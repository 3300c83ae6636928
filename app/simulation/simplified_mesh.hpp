// A mesh with fewer triangles, for what need not be exact: collisions, shadows, pictures of parts
// that are small in the image.
#pragma once

#include <cstddef>

#include "simulation/triangle_mesh.hpp"

namespace binpick::simulation {

// Unchanged where it has no more triangles than that. Otherwise vertices in the same cell of a grid
// become one, their mean, with the smallest cells that leave at most `triangles_max`.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t triangles_max);

}  // namespace binpick::simulation
