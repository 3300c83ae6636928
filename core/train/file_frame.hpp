// Unit and axes of a CAD file. The formats differ in both, and assimp turns some of them to metres
// and y up, some not; here every format comes back to the frame of the CAD program: z is up.
#pragma once

#include <assimp/scene.h>

#include <string>

namespace binpick::train {

struct FileFrame {
  double mm_per_unit = 0;  // 0: the format has no unit
  bool turned = false;     // another axis than z was up
};

// Puts the turn of the axes into the root of a scene that assimp read from the file, and takes out
// what assimp did there itself: then coordinates are the file's numbers, with z up. Throws
// ImportError with the fault alone: a unit or an axis that there is not.
FileFrame apply_file_frame(const std::string& path, aiScene& scene);

}  // namespace binpick::train
