// STEP and IGES: solids and curved surfaces, which binpick-cad turns into triangles. It is a
// program of its own, so that OpenCASCADE is needed by nobody who does not read such files.
#pragma once

#include <string>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

bool holds_solids(const std::string& path);

// The bytes of a PLY file in mm, and what binpick-cad remarked. Runs in the reading process, whose
// limits hold for binpick-cad too. Throws ImportError with the fault alone, binpick-cad's own or
// that it is not installed; a signal that ended binpick-cad ends this process.
std::string triangles_of_solids(const std::string& path, const SolidChoice& choice,
                                std::string& remarks);

}  // namespace binpick::train
