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

// kOfFile: as the file says. Where its format has no unit (STL, PLY, OBJ, ...) it is guessed, and
// the guess is in the notes: millimetres, but metres when the largest extent in the file is
// below 1. The numbers are in model files.
enum class LengthUnit {
  kOfFile = 0,
  kMillimetre = 1,
  kMetre = 2,
  kInch = 3,
  kCentimetre = 4,
  kFoot = 5,
  kMicrometre = 6,
  kOther = 7  // a file's own; nobody can ask for it
};

// The unit of a model file's number; kOfFile where nobody could have asked for it.
constexpr LengthUnit unit_of_number(int number) {
  const bool known = number > static_cast<int>(LengthUnit::kOfFile) &&
                     number < static_cast<int>(LengthUnit::kOther);
  return known ? static_cast<LengthUnit>(number) : LengthUnit::kOfFile;
}

// Of STEP and IGES files, which hold bodies with curved surfaces.
struct SolidChoice {
  std::string body;          // name, number from 1, or "all"; empty: the only one
  double deflection_mm = 0;  // of triangles from the surface, at most; 0: by the size of the part
};

// What was read, and what was repaired or guessed on the way; each note is one sentence for people.
struct ImportedMesh {
  Mesh mesh;
  LengthUnit unit = LengthUnit::kMillimetre;  // of the file: as given, as it says, or guessed
  std::vector<std::string> notes;
  std::uint64_t source_hash = 0;  // FNV-1a 64 of the file's bytes
};

// Reads STL, PLY, OBJ, glTF, COLLADA, 3MF, FBX, ... through assimp, in a child process with limits
// on time and memory, so that a hostile file that crashes or hangs the reader is an error here.
// Axes are those of the CAD program: where the file has another axis up (glTF always, COLLADA and
// FBX as they say), the part is turned so that z is up, and x stays to the right. Cleans the
// result: merges equal vertices, drops degenerate and duplicate triangles, reports open edges.
// STEP and IGES files go through the program binpick-cad. Throws ImportError with one sentence that
// names the file and the fault: unreadable, no triangles,
// NaN or infinite vertices, indices out of range, larger than limits (512 MiB, 2 million triangles,
// 120 s), zero extent, an extent outside 0.5 to 5000 mm. Thread-safe.
ImportedMesh import_mesh(const std::string& path, LengthUnit unit, const SolidChoice& solids = {});

struct MeshBounds {
  Vec3 min_mm, max_mm;
  double diameter_mm = 0;  // largest distance between two vertices, within 0.1 %
};
MeshBounds mesh_bounds(const Mesh& mesh);

}  // namespace binpick::train
