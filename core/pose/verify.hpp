// How well a pose explains what was measured.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct Evidence {
  int samples = 0;       // of the surface visible from this viewpoint
  double supported = 0;  // measured where the model is: 1 for a perfect fit, less with the residual
  int measured = 0;      // of the samples: with a depth that neither hides nor contradicts them
  int hidden = 0;        // something lies in front: neither for nor against
  int contradicted = 0;  // measured surface lies behind the model's: the model cannot be here
  int unknown = 0;       // no depth there
  int contours = 0;      // contour points that nothing hides
  double contours_supported = 0;
  double residual_mm = 0;      // median |point to plane| of the supported samples
  double sample_area_mm2 = 0;  // projected area that a sample stands for

  double visible_fraction() const {
    return samples > 0 ? 1.0 - static_cast<double>(hidden) / samples : 0;
  }
  double depth_support() const {
    const double tested = measured + 1.5 * contradicted;
    return tested > 0 ? supported / tested : 0;
  }
  double contour_support() const { return contours > 0 ? contours_supported / contours : 0; }
  // Share of the visible surface for which there is a measurement at all.
  double measured_fraction() const {
    return samples > 0 ? static_cast<double>(measured + contradicted) / samples : 0;
  }
  // How right the pose is, in [0, 1]: what is seen of the part fits.
  double score() const;
  // How much of the scene the pose explains, in mm^2 discounted by misfit. Of two poses that fit
  // the same pixels, the one that also explains their neighbours is right: a pipe seen end to end
  // is not a tee whose branch points away.
  double explained_mm2() const;
};

// Cosine between a model normal (camera axes) at a point and the normal measured at a pixel; 1
// where none was measured.
double normal_agreement(const Scene& scene, int u, int v, const Vec3& point_cam, const Vec3& n_cam);

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

}  // namespace binpick
