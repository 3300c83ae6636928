// How well a pose explains what was measured.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/contour.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct Evidence {
  Modality seen = Modality::kDepth;  // what the frame has
  int samples = 0;                   // of the surface visible from this viewpoint
  double supported = 0;  // measured where the model is: 1 for a perfect fit, less with the residual
  int measured = 0;      // of the samples: with a depth that neither hides nor contradicts them
  int hidden = 0;        // something lies in front: neither for nor against
  int contradicted = 0;  // measured surface lies behind the model's: the model cannot be here
  int unknown = 0;       // no depth there
  int contours = 0;      // contour points that nothing hides
  double contours_supported = 0;
  int outline_unseen = 0;        // contour points without depth at or beside them, and no step
  int outline_steps = 0;         // contour points on a depth step of their direction
  int outline_continued = 0;     // contour points with one smooth surface on both sides
  int outline_matches = 0;       // contour points beside an intensity edge, not on a depth step
  double outline_offset_px = 0;  // sum of their distances to it
  int creases = 0;               // crease points that nothing hides
  double creases_supported = 0;
  // Where only the intensity is seen (contour_evidence.hpp).
  double weakest_side = 1;  // support of the outline on the side where it has least
  int plain = 0;            // samples of the surface away from outline and creases
  int stray_edges = 0;      // of those on an edge
  double residual_mm = 0;   // median |point to plane| of the supported samples
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

// Cosine between a model normal (camera axes) at a point and the normal measured at a pixel; 1
// where none was measured.
double normal_agreement(const Scene& scene, int u, int v, const Vec3& point_cam, const Vec3& n_cam);

// Up to this far before a contour something hides it.
double contour_tolerance_mm(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);
// Whether a depth step of the contour's direction lies at its place or beside it.
bool on_depth_edge(const Scene& scene, const Vec3& point_cam, const Vec2& normal_px);
// Whether the surface at the contour goes on beyond it: near depth on both sides.
bool surface_continues(const Scene& scene, const ContourPlace& place, double tolerance_mm);

Evidence verify(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

}  // namespace binpick
