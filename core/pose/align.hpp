// Registration of a pose with the frame: one loop, and a schedule that says which residuals it
// minimizes, how far they reach, and for how long (paper section III-D: PnP, then ICP).
#pragma once

#include <span>

#include "pose/normal_equations.hpp"
#include "pose/scene.hpp"

namespace binpick {

enum class Residuals {
  kDepth,            // measured surface, point to plane
  kContour,          // image edges of the contour's direction, point to line
  kDepthAndContour,  // both, each in units of its noise; edges of any direction
};

// One row of a schedule. Ranges go from start to end, the gate in equal ratios.
struct AlignStep {
  Residuals residuals;
  int iterations_max;
  int samples_start, samples_end;  // of the surface, at most
  // From a template's pose: depth residuals are gated wide at the start, and where too little holds
  // the pose it is lost. Else the gate is narrow, and a pose that little holds stays as it is.
  bool from_template;
  int range_start_px, range_end_px;  // to an edge
  double prior;  // that the pose stays, as a share of the residuals' information
};

// From a template's pose into the basin of the refinement.
std::span<const AlignStep> coarse_alignment(const Scene& scene);
// To the end.
std::span<const AlignStep> fine_alignment(const Scene& scene);

// False where the pose is lost: too little holds it, or it leaves the neighbourhood of where it
// began.
// Basin on depth: about 10 degrees and a tenth of the part's diameter where three faces are in
// sight; along a plate seen from the front the ICP slides, and only contours hold it
// (tests/core/align_test.cpp).
[[nodiscard]] bool align(const ObjectModel& model, const Scene& scene,
                         std::span<const AlignStep> schedule, Pose& T_cam_centre);

// The residuals at the end of the fine alignment.
NormalEquations final_equations(const ObjectModel& model, const Scene& scene,
                                const Pose& T_cam_centre);

}  // namespace binpick
