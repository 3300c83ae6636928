// What the pose stages see of a frame: measured depth and normals, intensity, and edges. All poses
// here are of the part's centre in the camera of the cropped region.
#pragma once

#include "features/pyramid.hpp"

namespace binpick {

struct Scene {
  const PyramidLevel& depth;      // level at which normals were fitted: depth averaged over 2x2 px
  const PyramidLevel& intensity;  // level 0
  double sensor_sigma_ratio;      // depth noise as a share of the depth

  explicit Scene(const FeaturePyramid& pyramid)
      : depth(pyramid.level(kFeatureLevel)),
        intensity(pyramid.level(0)),
        sensor_sigma_ratio(0.0006) {}

  // Measured depth at the pixel nearest to (u, v) of the depth level; 0 where there is none.
  float depth_at(int u, int v) const {
    return u >= 0 && v >= 0 && u < depth.width && v < depth.height
               ? depth.depth_mm[v * depth.stride + u]
               : 0.0f;
  }
};

}  // namespace binpick
