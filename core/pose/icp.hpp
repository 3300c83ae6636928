// Alignment of the visible model surface with the measured depth.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/normal_equations.hpp"
#include "pose/scene.hpp"

namespace binpick {

// Moves the pose along its viewing ray to where the measured surface is: the densest group among
// the depth differences of the visible samples, so that occluders in front and background behind do
// not pull. `range_mm`: how far it may move. False where too few samples agree.
bool align_depth(const ObjectModel& model, const Scene& scene, double range_mm, Pose& T_cam_centre);

struct IcpParams {
  int iterations_max = 12;
  int sample_step = 1;  // uses every n-th surface sample
  double gate_start_mm =
      6;  // pairs farther apart along the ray are left out; shrinks geometrically
  double gate_end_mm = 2;
};

struct IcpResult {
  int pairs = 0;      // in the last iteration
  double rms_mm = 0;  // point to plane, over those
};

// Robust point-to-plane ICP with projective association: each visible sample is paired with the
// depth measured at its pixel. Basin: about 10 degrees and a tenth of the part's diameter where
// three faces are in sight; along a plate seen from the front it slides, and only refine()'s
// contours hold it (tests/core/icp_test.cpp).
IcpResult icp(const ObjectModel& model, const Scene& scene, const IcpParams& params,
              Pose& T_cam_centre);

// Adds the point-to-plane residuals of one pass, each divided by sigma_mm; Geman-McClure weights
// with scale gate_mm.
int add_depth_residuals(const Viewpoint& view, const ObjectModel& model, const Scene& scene,
                        const Pose& T_cam_centre, int sample_step, double gate_mm, double sigma_mm,
                        NormalEquations& equations);

}  // namespace binpick
