// What counts as the same surface at one pose: everything that compares a measured depth with a
// predicted one asks here.
#pragma once

#include <algorithm>

#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct Tolerances {
  double noise_mm;       // random error of one depth; it averages out over a surface
  double on_surface_mm;  // up to this far from the model, a measured point lies on it
  double conflict_mm;    // beyond this, something hides the model, or shows that it is not there

  // The sensor's window and its false matches distort shapes by about twice the noise, and a point
  // is taken for one of the surface up to two such errors. Nothing is known better than 0.8 % of
  // the diameter: models, and how well a pose can be aligned, have errors too.
  Tolerances(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre)
      : noise_mm(scene.depth_noise_mm(T_cam_centre.t_mm.z())),
        on_surface_mm(std::max(4.4 * noise_mm, 0.008 * model.info().diameter_mm)),
        conflict_mm(4 * on_surface_mm) {}
};

}  // namespace binpick
