// Local geometry of a depth image: surface normals by plane fit, and depth edges. The same code
// reads rendered depth at training and specifies what the vector kernels make of measured depth.
#pragma once

#include <cstdint>

#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/camera_model.hpp"

namespace binpick {

// A normal in the frame of its own viewing ray: unit vector (x, y, -sqrt(1 - x^2 - y^2)); where a
// template stands in the image then does not matter (only the ray does). All 0 where no plane fits.
struct RayNormal {
  float x = 0, y = 0;
  bool valid = false;
};

// Neighbours whose depth differs by more than this share of the depth lie on another surface.
inline constexpr float kSameSurfaceRatio = 0.008f;
// A step by more than this share of the depth is an edge of the part's outline.
inline constexpr float kDepthEdgeRatio = 0.003f;
// A step must be this many standard deviations of 1/z: four of a second difference.
inline constexpr float kStepInNoise = 10;
// A plane needs this many pixels, and a determinant of its normal equations that a line has not.
inline constexpr int kPlanePixelsMin = 10;
inline constexpr float kPlaneDeterminantMin = 100;

// Least-squares plane through the 5x5 neighbourhood of (x, y), anchored at the centre; pixels that
// are invalid (0) or on another surface are left out. (x, y) at least 2 px from the border.
RayNormal fit_ray_normal(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int x,
                         int y);

// Direction (gx, gy) of the depth step at (x, y), towards the far side, or (0, 0) where there is
// none. Only pixels on the near side of a step have one; missing depth counts as far. In units of
// the smallest step, at most 16 each. `noise`: standard deviation of 1/z in 1/mm; steps that it may
// be the cause of are none. (x, y) at least 1 px from the border.
struct DepthStep {
  float gx = 0, gy = 0;
  bool edge = false;
};
DepthStep depth_step(ImageView<const float> depth_mm, int x, int y, float noise = 0);

}  // namespace binpick
