// A triangle mesh in mm: what training learns a part from.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "binpick/geometry/pose.hpp"

namespace binpick::train {

struct Mesh {
  std::vector<Eigen::Vector3f> vertices_mm;
  // Indices into vertices_mm, counter-clockwise.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// kGuess: metres for glTF, as its standard prescribes; else millimetres, but metres when the
// largest extent in the file is below 1. The guess is in the notes.
enum class LengthUnit { kGuess, kMillimetre, kMetre, kInch };

// What was read, and what was repaired or guessed on the way; each note is one sentence for people.
struct ImportedMesh {
  Mesh mesh;
  LengthUnit unit = LengthUnit::kMillimetre;  // the unit of the file, as given or guessed
  std::vector<std::string> notes;
  std::uint64_t source_hash = 0;  // FNV-1a 64 of the file's bytes
};

// Reads STL, PLY, OBJ, glTF, OFF, 3DS, ... through assimp, in a child process with limits on time
// and memory, so that a hostile file that crashes or hangs the reader is an error here. Cleans the
// result: merges equal vertices, drops degenerate and duplicate triangles, reports open edges.
// Throws ImportError with one sentence that names the file and the fault: unreadable, no triangles,
// NaN or infinite vertices, indices out of range, larger than limits (512 MiB, 2 million triangles,
// 120 s), zero extent, an extent outside 0.5 to 5000 mm. Thread-safe.
ImportedMesh import_mesh(const std::string& path, LengthUnit unit);

struct MeshBounds {
  Vec3 min_mm, max_mm;
  double diameter_mm = 0;  // largest distance between two vertices, within 0.1 %
};
MeshBounds mesh_bounds(const Mesh& mesh);

}  // namespace binpick::train
