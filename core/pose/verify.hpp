// How well a pose explains what was measured: evidence, from which score.hpp makes a probability.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct Evidence {
  Modality seen = Modality::kDepth;  // what the frame has
  int samples = 0;                   // of the surface visible from this viewpoint
  double supported = 0;  // measured where the model is: 1 for a perfect fit, less with the residual
  int measured = 0;      // of the samples: with a depth that neither hides nor contradicts them
  int hidden = 0;        // something lies in front: neither for nor against
  int contradicted = 0;  // measured surface lies behind the model's: the model cannot be here
  int contours = 0;      // outline points that nothing hides
  double contours_supported = 0;
  int outline_steps = 0;         // outline points on a depth step of their direction
  int outline_matches = 0;       // outline points beside an intensity edge, not on a depth step
  int outline_bare = 0;          // without depth: outline points with no edge of any direction
  double outline_offset_px = 0;  // sum of the matches' distances to their edges
  int creases = 0;               // crease points that nothing hides
  double creases_supported = 0;
  // How much of the scene the pose explains, in the image's projection. Of two poses that fit the
  // same pixels, the one that also explains their neighbours is right: a pipe seen end to end is
  // not a tee whose branch points away.
  double explained_mm2 = 0;
  double px2_per_mm2 = 0;  // of the image, at the part's distance

  double visible_fraction() const {
    return samples > 0 ? 1.0 - static_cast<double>(hidden) / samples : 0;
  }
  double depth_support() const {
    const double tested = measured + 1.5 * contradicted;
    return tested > 0 ? supported / tested : 0;
  }
  // Share of what nothing hides for which there is a measurement.
  double known_fraction() const {
    const int shown = samples - hidden;
    return shown > 0 ? static_cast<double>(measured + contradicted) / shown : 0;
  }
  double contour_support() const { return contours > 0 ? contours_supported / contours : 0; }
  // Share of the visible surface for which there is a measurement at all.
  double measured_fraction() const {
    return samples > 0 ? static_cast<double>(measured + contradicted) / samples : 0;
  }
};

// How samples of a viewpoint's surface agree with the measured depth.
simd::SurfaceAgreement surface_agreement(const Scene& scene, const Viewpoint& view,
                                         const SampleArrays& surface, const Pose& T_cam_centre,
                                         const simd::SurfaceTolerance& tolerance);

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

// Median |point to plane| of the samples that agree with the measured depth; 0 where none does.
double depth_residual_mm(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

}  // namespace binpick
