// What the intensity alone says of a pose.
#pragma once

#include "pose/verify.hpp"

namespace binpick {

// Of a pose as a template gives it: how many of its contour points lie on an edge of their
// direction, beyond what chance would put there, -1 .. 1.
double contour_promise(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

// As verify(), by outline, creases and edges where the part has none. What hides a part, and what
// lies behind it, cannot be seen: it speaks neither for nor against.
Evidence contour_evidence(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

}  // namespace binpick
