// Contour evidence: model outline and creases against edges of the intensity and depth images.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/normal_equations.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct ContourMatch {
  bool hidden = false;    // something in front covers this contour point
  bool found = false;     // an edge of the right direction lies within the search range
  double offset_px = 0;   // signed distance to it along normal_px, level 0
  double strength = 0;    // contrast of the edge in gray levels
  Vec2 normal_px = Vec2::Zero();  // unit, in the image
  Vec3 point_cam = Vec3::Zero();
};

// Looks for the image edge near one contour sample, along the contour's normal, up to range_px on either side.
ContourMatch match_contour(const ContourSample& sample, const Scene& scene, const Pose& T_cam_centre, int range_px,
                           double depth_tolerance_mm);

// Adds the point-to-line reprojection residuals (px) of one pass, each divided by sigma_px, with Geman-McClure weights of scale range_px.
// Returns how many contour points found an edge.
int add_contour_residuals(const Viewpoint& view, const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
                          int range_px, double sigma_px, double depth_tolerance_mm, NormalEquations& equations);

}  // namespace binpick
