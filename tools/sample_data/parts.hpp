// The parts of a data set: their meshes and what the truth says of them. Some are made here, others
// are read from files.
#pragma once

#include <string>
#include <vector>

#include "simulation/part.hpp"

namespace binpick::simulation {

TriangleMesh make_tee();   // reducing tee of a pipe system, hexagon on the branch
TriangleMesh make_clip();  // L clip of 2 mm sheet with round holes and a slot
TriangleMesh make_hub();   // stepped shaft with flange, hexagon socket and a lug to one side
TriangleMesh make_bolt();  // M10 hexagon bolt with a helical thread: nearly 15000 triangles

// Tee, clip and hub as obj 1, 2, 3.
std::vector<Part> make_own_parts();
// Meshes from files, and "bolt" for the bolt. A name like obj_000004.ply gives the id, otherwise
// ids count from 1; symmetries come from a models_info.json beside the file when it lists the id.
std::vector<Part> read_parts(const std::vector<std::string>& paths);

}  // namespace binpick::simulation
