// The contents of a CAD file as assimp sees them: everything in one list of triangles, in the
// file's unit. assimp crashes or hangs on hostile files: call it through read_in_child only.
#pragma once

#include <cstdint>
#include <string>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

struct FileContent {
  Mesh mesh;                        // not cleaned, in the file's unit, with z up
  std::uint64_t skipped_count = 0;  // points and lines
  std::string remarks;              // sentences; what the reader mended, left out or turned
  double mm_per_unit = 0;           // 0: the file does not say
};

constexpr std::size_t kTrianglesMax = 2'000'000;
constexpr std::size_t kVerticesMax = 4 * kTrianglesMax;  // STL brings three a triangle

// The extension of a file's name, in lower case.
std::string extension_of(const std::string& path);

// Throws ImportError with the fault alone.
FileContent read_with_assimp(const std::string& path, const SolidChoice& solids = {});

}  // namespace binpick::train
