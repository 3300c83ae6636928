#include "simd/surface_slope.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
RayNormal fit_ray_normal(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int x,
                         int y) {
  const float z = depth_mm.at(x, y);
  RayNormal out;
  if (!(z > 0)) return out;
  const float limit = z * kSameSurfaceRatio;
  int count = 0, a11 = 0, a12 = 0, a22 = 0;
  float b1 = 0, b2 = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    const float* row = depth_mm.row(y + dy) + x;
    float d[5];
    for (int dx = -2; dx <= 2; ++dx) {
      const float dz = row[dx] - z;
      const bool same_surface = std::fabs(dz) <= limit;
      d[dx + 2] = same_surface ? dz : 0.0f;
      if (!same_surface) continue;
      ++count;
      a11 += dx * dx;
      a12 += dx * dy;
      a22 += dy * dy;
    }
    b1 += 2 * (d[4] - d[0]) + (d[3] - d[1]);
    b2 += static_cast<float>(dy) * (((d[0] + d[1]) + (d[3] + d[4])) + d[2]);
  }
  const float f11 = static_cast<float>(a11), f12 = static_cast<float>(a12),
              f22 = static_cast<float>(a22);
  const float det = f11 * f22 - f12 * f12;
  if (count < kPlanePixelsMin || det < kPlaneDeterminantMin) return out;
  // Slopes of ln z against the tangents of the viewing angles; see the derivation in
  // ARCHITECTURE.md.
  const float fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float scale = 1 / (det * z);
  const float p = (f22 * b1 - f12 * b2) * scale * fx;
  const float q = (f11 * b2 - f12 * b1) * scale * fy;
  const float xr = (static_cast<float>(x) - static_cast<float>(camera.cx)) / fx;
  const float yr = (static_cast<float>(y) - static_cast<float>(camera.cy)) / fy;
  const float nz = -(1 + xr * p + yr * q);
  const float inv_n = 1 / std::sqrt(p * p + q * q + nz * nz);
  const float rz = 1 / std::sqrt(1 + xr * xr + yr * yr);
  const float rx = xr * rz, ry = yr * rz, k = 1 / (1 + rz);
  // First two rows of the transposed rotation that takes the optical axis to the ray.
  out.x = ((1 - rx * rx * k) * p - rx * ry * k * q - rx * nz) * inv_n;
  out.y = ((1 - ry * ry * k) * q - rx * ry * k * p - ry * nz) * inv_n;
  out.valid = true;
  return out;
}

DepthStep depth_step(ImageView<const float> depth_mm, int x, int y, float noise) {
  const float z = depth_mm.at(x, y);
  DepthStep out;
  if (!(z > 0)) return out;
  const float per_step = 1 / (z * std::max(kDepthEdgeRatio, (kStepInNoise * noise) * z));
  float d[3][3];
  for (int j = 0; j < 3; ++j) {
    const float* row = depth_mm.row(y + j - 1) + x - 1;
    for (int i = 0; i < 3; ++i)
      d[j][i] = row[i] > 0 ? std::clamp((row[i] - z) * per_step, -2.0f, 2.0f) : 2.0f;
  }
  out.gx = (d[0][2] + 2 * d[1][2] + d[2][2]) - (d[0][0] + 2 * d[1][0] + d[2][0]);
  out.gy = (d[2][0] + 2 * d[2][1] + d[2][2]) - (d[0][0] + 2 * d[0][1] + d[0][2]);
  // Second differences: a slope is no step, however steep.
  const float bend = std::max(std::max(d[1][0] + d[1][2], d[0][1] + d[2][1]),
                              std::max(d[0][0] + d[2][2], d[0][2] + d[2][0]));
  out.edge = bend >= 1 && out.gx * out.gx + out.gy * out.gy >= 4;
  return out;
}

}  // namespace binpick
