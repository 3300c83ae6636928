// How well the data hold a pose.
#pragma once

#include <array>

#include "binpick/geometry/pose.hpp"

namespace binpick {

struct PoseUncertainty {
  // Of a small turn (rotation vector, rad) and then a shift (mm) of the part's centre, both in
  // camera axes, applied to T_cam_obj from the left about the centre; row-major.
  std::array<double, 36> covariance{};
  // The directions that the data hold least, unit vectors in camera axes, and the standard
  // deviations along and about them.
  Vec3 weak_shift = Vec3::UnitZ(), weak_turn = Vec3::UnitZ();
  double weak_shift_mm = 0, weak_turn_rad = 0;
  // False where the data say next to nothing: the part may as well lie some twentieth of its
  // diameter further along, or be turned by as much as moves its surface so far.
  bool shift_observable = true, turn_observable = true;
};

}  // namespace binpick
