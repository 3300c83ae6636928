// What the pose stages see of a frame: measured depth and normals, intensity, and edges. All poses
// here are of the part's centre in the camera of the cropped region.
#pragma once

#include <algorithm>
#include <cmath>

#include "binpick/frame/modality.hpp"
#include "features/pyramid.hpp"

namespace binpick {

// The whole pixel nearest to a place. What is far from any image, or no number, stays outside.
// Without std::lround(), whose call is a good part of a look at a pixel.
inline int nearest_pixel(double place) {
  const double x = std::min(std::max(-1e6, place), 1e6) + 0.5;
  const int cut = static_cast<int>(x);  // towards zero
  return cut - (static_cast<double>(cut) > x);
}

struct Scene {
  const PyramidLevel& depth;      // level at which normals were fitted: depth averaged over 2x2 px
  const PyramidLevel& intensity;  // level 0
  const bool with_intensity;      // level 0 shows something
  const bool with_depth;          // there is a depth image, whatever was measured
  const double noise;             // of the depth: standard deviation of 1/z, 1/mm

  explicit Scene(const FeaturePyramid& pyramid)
      : depth(pyramid.level(kFeatureLevel)),
        intensity(pyramid.level(0)),
        with_intensity(pyramid.with_intensity()),
        with_depth(pyramid.with_depth()),
        noise(pyramid.depth_noise().of_patches) {}

  Modality modality() const {
    if (!with_depth) return Modality::kIntensity;
    return with_intensity ? Modality::kDepthAndIntensity : Modality::kDepth;
  }

  // Depth error to reckon with at one point, shape distorted by the sensor's window included. A
  // triangulating sensor finds its matches to a fraction of a pixel, and its baseline is a fraction
  // of the distance: the product is about the width that a pixel covers on the surface. A sensor
  // whose frame scatters more than that allows is reckoned with as it is.
  double depth_error_mm(double depth_mm) const { return 2.2 * depth_noise_mm(depth_mm); }
  // Its random part, which averages out over a surface.
  double depth_noise_mm(double depth_mm) const {
    return std::max(0.5 * depth_mm / intensity.camera.fx, DepthNoise::mm(noise, depth_mm));
  }

  // At a pixel of the depth level; 0 where there is no measurement, and outside.
  double depth_at(int u, int v) const {
    const bool inside = u >= 0 && v >= 0 && u < depth.width && v < depth.height;
    return inside ? static_cast<double>(depth.depth_mm[v * depth.stride + u]) : 0.0;
  }
  // What the depth level shows where a point projects to.
  struct Measurement {
    int u, v;         // nearest pixel; may lie outside the image
    double depth_mm;  // 0 where there is none
  };
  Measurement measured_at(const Vec3& point_cam) const {
    const Vec2 uv = depth.camera.project(point_cam);
    const int u = nearest_pixel(uv.x()), v = nearest_pixel(uv.y());
    return {u, v, depth_at(u, v)};
  }
  // Whether a point of a surface lies on what was measured where it projects to, as far as the
  // sensor's error lets that be told at this distance.
  bool lies_on_measured(const Measurement& m, const Vec3& point_cam, const Vec3& n_cam,
                        double distance_mm) const {
    return m.depth_mm > 0 &&
           std::abs(n_cam.dot(depth.camera.unproject(m.u, m.v, m.depth_mm) - point_cam)) <
               2 * depth_error_mm(distance_mm);
  }
  // Measured depth at a pixel of level 0; 0 where there is none.
  double measured_px(const Vec2& pixel) const {
    const double scale = 1 << kFeatureLevel;
    return depth_at(nearest_pixel((pixel.x() + 0.5) / scale - 0.5),
                    nearest_pixel((pixel.y() + 0.5) / scale - 0.5));
  }
  // Area in the image of what faces the camera at this depth.
  double px2_per_mm2(double depth_mm) const {
    return intensity.camera.fx * intensity.camera.fy / (depth_mm * depth_mm);
  }
};

}  // namespace binpick
