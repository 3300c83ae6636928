// Poses of frames without depth: all six parameters from the contour, the distance by the size of
// its image.
#pragma once

#include "pose/directed_edge.hpp"
#include "pose/normal_equations.hpp"

namespace binpick {

// PnP on the contour, repeated: each solution finds its edges anew, nearer by. False where too few
// points have an edge, or the pose leaves the neighbourhood of where it began.
bool pose_from_contour(const ObjectModel& model, const Scene& scene, Pose& T_cam_centre);

// The residuals of one pass in units of the noise of an edge; how many there are.
int add_directed_residuals(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
                           int range_px, NormalEquations& equations);

// To convergence, edges farther away than the last range left out.
void refine_on_contour(const ObjectModel& model, const Scene& scene, Pose& T_cam_centre);

// Within how many pixels an edge belongs to a refined contour.
inline constexpr int kRefinedRangePx = 2;

}  // namespace binpick
