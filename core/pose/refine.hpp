// Last refinement: depth and contour together, each in units of its own noise, so that contours
// hold the directions along which a flat or round surface slides.
#pragma once

#include "pose/contour.hpp"
#include "pose/icp.hpp"

namespace binpick {

struct RefineParams {
  int iterations_max = 8;
  double depth_gate_mm = 2.5;
  int contour_range_start_px = 6;
  int contour_range_end_px = 2;
  double contour_sigma_px = 1.0;
};

// With the gate for this part at this distance in this frame.
RefineParams refine_params(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

// The residuals of one pass, depth and contour, at a pose that is seen from near the viewpoint; how
// many there are.
int add_residuals(const ObjectModel& model, const Viewpoint& view, const Scene& scene,
                  const RefineParams& params, int contour_range_px, const Pose& T_cam_centre,
                  NormalEquations& equations);

void refine(const ObjectModel& model, const Scene& scene, const RefineParams& params,
            Pose& T_cam_centre);

}  // namespace binpick
