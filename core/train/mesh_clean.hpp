// What a file delivered becomes a mesh to learn from: each vertex once, each triangle once, nothing
// without an area. Says in `notes` what was changed and what looks wrong but was left.
#pragma once

#include <string>
#include <vector>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

// Throws ImportError with the fault alone, for the caller to put the file's name before it: an
// index out of range, a vertex in use that is not a number, nothing left.
Mesh clean_mesh(Mesh mesh, std::vector<std::string>& notes);

}  // namespace binpick::train
