// Contour evidence: model outline and creases against edges of the intensity and depth images.
#pragma once

#include "binpick/model/object_model.hpp"
#include "pose/normal_equations.hpp"
#include "pose/scene.hpp"

namespace binpick {

// Where a contour sample projects to.
struct ContourPlace {
  bool visible = false;           // inside the region, and nothing in front of it
  Vec2 pixel = Vec2::Zero();      // level 0
  Vec2 normal_px = Vec2::Zero();  // unit, across the contour
  Vec3 point_cam = Vec3::Zero();
};

// The image edge beside it.
struct ContourMatch {
  bool found = false;
  double offset_px = 0;  // signed distance along normal_px
};

ContourPlace place_contour(const ContourSample& sample, const Scene& scene,
                           const Pose& T_cam_centre, int range_px, double depth_tolerance_mm);

// Looks for the intensity edge nearest to the place, along the contour's normal, up to range_px on
// either side.
ContourMatch match_contour(const ContourPlace& place, const Scene& scene, int range_px);

// Edges are told apart by eight directions, as bits (features/orientation). Which of them an edge
// across a unit normal has, and that one with its neighbours.
int edge_direction(const Vec2& normal);
unsigned edge_directions_near(const Vec2& normal);

// Derivative of the offset along the contour's normal by the point in the camera.
Vec3 pulled_back(const ContourPlace& place, const CameraIntrinsics& camera);

// Adds the point-to-line reprojection residuals (px) of one pass, each divided by sigma_px, with
// Geman-McClure weights of scale range_px. Returns how many contour points found an edge.
int add_contour_residuals(const Viewpoint& view, const ObjectModel& model, const Scene& scene,
                          const Pose& T_cam_centre, int range_px, double sigma_px,
                          double depth_tolerance_mm, NormalEquations& equations);

}  // namespace binpick
