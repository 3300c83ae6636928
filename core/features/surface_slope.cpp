#include "features/surface_slope.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
namespace {

// Four standard deviations of a second difference.
constexpr float kStepInNoise = 10;

}  // namespace

RayNormal fit_ray_normal(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int x,
                         int y) {
  const float z = depth_mm.at(x, y);
  RayNormal out;
  if (!(z > 0)) return out;
  const float limit = z * kSameSurfaceRatio;
  float a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
  int count = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    const float* row = depth_mm.row(y + dy) + x;
    for (int dx = -2; dx <= 2; ++dx) {
      const float dz = row[dx] - z;
      if (!(std::fabs(dz) <= limit)) continue;
      ++count;
      const float fx = static_cast<float>(dx), fy = static_cast<float>(dy);
      a11 += fx * fx;
      a12 += fx * fy;
      a22 += fy * fy;
      b1 += fx * dz;
      b2 += fy * dz;
    }
  }
  const float det = a11 * a22 - a12 * a12;
  if (count < 10 || det < 100) return out;
  // Slopes of ln z against the tangents of the viewing angles; see the derivation in
  // ARCHITECTURE.md.
  const float p = (a22 * b1 - a12 * b2) / det * static_cast<float>(camera.fx) / z;
  const float q = (a11 * b2 - a12 * b1) / det * static_cast<float>(camera.fy) / z;
  const float xr =
      (static_cast<float>(x) - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx);
  const float yr =
      (static_cast<float>(y) - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy);
  const float nz = -(1 + xr * p + yr * q);
  const float inv_n = 1 / std::sqrt(p * p + q * q + nz * nz);
  const float inv_r = 1 / std::sqrt(1 + xr * xr + yr * yr);
  const float rx = xr * inv_r, ry = yr * inv_r, rz = inv_r;
  const float k = 1 / (1 + rz);
  // First two rows of the transposed rotation that takes the optical axis to the ray.
  out.x = ((1 - rx * rx * k) * p - rx * ry * k * q - rx * nz) * inv_n;
  out.y = (-rx * ry * k * p + (1 - ry * ry * k) * q - ry * nz) * inv_n;
  out.valid = true;
  return out;
}

DepthStep depth_step(ImageView<const float> depth_mm, int x, int y, float noise) {
  const float z = depth_mm.at(x, y);
  DepthStep out;
  if (!(z > 0)) return out;
  const float per_step = 1 / (z * std::max(kDepthEdgeRatio, kStepInNoise * noise * z));
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
