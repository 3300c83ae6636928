// Local geometry of a depth image: surface normals by plane fit, and depth edges. The same code
// reads rendered depth at training and measured depth at detection.
#pragma once

#include <cstdint>

#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/camera_model.hpp"
#include "binpick/model/normal_codebook.hpp"

namespace binpick {

// A normal in the frame of its own viewing ray: unit vector (x, y, -sqrt(1 - x^2 - y^2)); where a
// template stands in the image then does not matter (only the ray does). valid is 0 where no plane
// fits.
struct RayNormal {
  float x = 0, y = 0;
  bool valid = false;
};

// Neighbours whose depth differs by more than this share of the depth lie on another surface.
inline constexpr float kSameSurfaceRatio = 0.008f;
// A step by more than this share of the depth is an edge of the part's outline.
inline constexpr float kDepthEdgeRatio = 0.003f;

// Least-squares plane through the (2r+1)^2 neighbourhood of (x, y), r = 2, anchored at the centre;
// pixels that are invalid (0) or on another surface are left out. (x, y) at least 2 px from the
// border.
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
