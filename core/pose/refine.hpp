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

void refine(const ObjectModel& model, const Scene& scene, const RefineParams& params,
            Pose& T_cam_centre);

}  // namespace binpick
