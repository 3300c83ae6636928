// Which viewpoints a symmetric part needs: from the others it looks the same.
#pragma once

#include <vector>

#include "train/symmetry.hpp"

namespace binpick::train {

// Whether each of the viewpoints (unit vectors from the part towards the camera) is the nearest one
// to some direction out of which, within the tilt limit, the part's exact symmetries make all
// others. Of equivalent directions the one nearest to the part's +z stands for all.
std::vector<char> needed_viewpoints(const std::vector<Vec3>& viewpoints, double tilt_max_deg,
                                    const FoundSymmetry& symmetry);

}  // namespace binpick::train
