// Meshes in files, in mm.
#pragma once

#include <string>

#include "simulation/triangle_mesh.hpp"

namespace binpick::simulation {

// Any format assimp reads, taken as mm. Throws std::runtime_error naming the file.
TriangleMesh read_mesh(const std::string& path);
void write_ply(const TriangleMesh& mesh, const std::string& path);  // binary little-endian
void write_stl(const TriangleMesh& mesh, const std::string& path);  // binary

}  // namespace binpick::simulation
