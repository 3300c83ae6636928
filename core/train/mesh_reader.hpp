// The contents of a CAD file as assimp sees them: everything in one list of triangles, in the
// file's unit. assimp crashes or hangs on hostile files: call it through read_in_child only.
#pragma once

#include <cstdint>
#include <string>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

struct FileContent {
  Mesh mesh;                        // not cleaned, in the file's unit
  std::uint64_t skipped_count = 0;  // points and lines
  std::string complaints;           // of the reader, who went on nevertheless
};

constexpr std::size_t kTrianglesMax = 2'000'000;
constexpr std::size_t kVerticesMax = 4 * kTrianglesMax;  // STL brings three a triangle

// Throws ImportError with the fault alone.
FileContent read_with_assimp(const std::string& path);

}  // namespace binpick::train
