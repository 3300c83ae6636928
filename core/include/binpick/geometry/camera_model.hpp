// Pinhole camera without distortion. A point projects to u = fx X/Z + cx, v = fy Y/Z + cy; integer
// (u, v) are pixel centres.
#pragma once

#include "binpick/geometry/pose.hpp"

namespace binpick {

struct CameraIntrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0;  // px
  double cx = 0, cy = 0;  // px

  bool valid() const;
  Vec2 project(const Vec3& x_cam) const {
    return {fx * x_cam.x() / x_cam.z() + cx, fy * x_cam.y() / x_cam.z() + cy};
  }
  // The point on the ray of pixel (u, v) whose z coordinate is depth_mm.
  Vec3 unproject(double u, double v, double depth_mm) const {
    return {(u - cx) / fx * depth_mm, (v - cy) / fy * depth_mm, depth_mm};
  }
  // Unit vector along the ray of pixel (u, v).
  Vec3 ray(double u, double v) const {
    return Vec3((u - cx) / fx, (v - cy) / fy, 1.0).normalized();
  }
  // The same camera after averaging 2^level x 2^level pixel blocks into one.
  CameraIntrinsics at_level(int level) const;
};

}  // namespace binpick
