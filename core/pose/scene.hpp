// What the pose steps see of a frame: measured depth and normals, intensity, and edges. All poses
// here are of the part's centre in the camera of the cropped region.
#pragma once

#include <algorithm>
#include <cmath>

#include "binpick/frame/modality.hpp"
#include "features/pyramid.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick {

// The whole pixel nearest to a place. What is far from any image, or no number, stays outside.
// Without std::lround(), whose call is a good part of a look at a pixel.
inline int nearest_pixel(double place) {
  const double x = std::min(std::max(-1e6, place), 1e6) + 0.5;
  const int cut = static_cast<int>(x);  // towards zero
  return cut - (static_cast<double>(cut) > x);
}

inline simd::PinholeF pinhole(const CameraIntrinsics& c) {
  return {static_cast<float>(c.fx), static_cast<float>(c.fy),     static_cast<float>(c.cx),
          static_cast<float>(c.cy), static_cast<float>(1 / c.fx), static_cast<float>(1 / c.fy)};
}

struct Scene {
  const PyramidLevel& depth;      // level at which normals were fitted: depth averaged over 2x2 px
  const PyramidLevel& intensity;  // level 0
  const bool with_intensity;      // level 0 shows something
  const bool with_depth;          // there is a depth image, whatever was measured
  const double noise;             // of the depth: standard deviation of 1/z, 1/mm
  const simd::PoseKernels& kernels;
  const simd::DepthMap depth_map;  // of `depth`
  const simd::GrayMap gray_map;    // of `intensity`

  // The pyramid and the kernels outlive the scene.
  Scene(const FeaturePyramid& pyramid, const simd::PoseKernels& pose_kernels)
      : depth(pyramid.level(kFeatureLevel)),
        intensity(pyramid.level(0)),
        with_intensity(pyramid.with_intensity()),
        with_depth(pyramid.with_depth()),
        noise(pyramid.depth_noise().of_patches),
        kernels(pose_kernels),
        depth_map{depth.depth_mm,
                  depth.normal_x,
                  depth.normal_y,
                  depth.normal_valid,
                  depth.width,
                  depth.height,
                  static_cast<std::int32_t>(depth.stride),
                  pinhole(depth.camera)},
        gray_map{intensity.gray, intensity.width, intensity.height,
                 static_cast<std::int32_t>(intensity.stride), pinhole(intensity.camera)} {}

  Modality modality() const {
    if (!with_depth) return Modality::kIntensity;
    return with_intensity ? Modality::kDepthAndIntensity : Modality::kDepth;
  }

  // Random error of one depth. A triangulating sensor finds its matches to a fraction of a pixel,
  // and its baseline is a fraction of the distance: the product is about half the width that a
  // pixel covers on the surface. Depth noise is never assumed to be smaller; where the frame
  // scatters more, that counts.
  double depth_noise_mm(double depth_mm) const {
    return std::max(0.5 * depth_mm / intensity.camera.fx, DepthNoise::mm(noise, depth_mm));
  }

  // At a pixel of the depth level; 0 where there is no measurement, and outside.
  float depth_at(int u, int v) const {
    const bool inside = u >= 0 && v >= 0 && u < depth.width && v < depth.height;
    return inside ? depth.depth_mm[v * depth.stride + u] : 0.0f;
  }
  // From level 0 to the depth level.
  static double depth_level_px(double px) { return (px + 0.5) / (1 << kFeatureLevel) - 0.5; }

  // Area in the image of what faces the camera at this depth.
  double px2_per_mm2(double depth_mm) const {
    return intensity.camera.fx * intensity.camera.fy / (depth_mm * depth_mm);
  }
};

}  // namespace binpick
