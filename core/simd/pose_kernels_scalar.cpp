#include <algorithm>
#include <cmath>

#include "simd/pose_kernels.hpp"

namespace binpick::simd {
namespace {

struct V3 {
  float x, y, z;
};
float dot(const V3& a, const V3& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
V3 turned(const PoseF& T, const V3& p) {
  const float* R = T.R;
  return {(R[0] * p.x + R[1] * p.y) + R[2] * p.z, (R[3] * p.x + R[4] * p.y) + R[5] * p.z,
          (R[6] * p.x + R[7] * p.y) + R[8] * p.z};
}
V3 position(const SampleArrays& s, int i) {
  return {s.x[i], s.y[i], s.z[i]};
}
V3 direction(const SampleArrays& s, int i) {
  return {s.dx[i], s.dy[i], s.dz[i]};
}
// Smaller and larger of two numbers; the second where one is not a number.
float min(float a, float b) {
  return a < b ? a : b;
}
float max(float a, float b) {
  return a > b ? a : b;
}

// A sample as the camera sees it.
struct Seen {
  V3 arm;  // from the part's centre
  V3 p, d;
};
Seen seen(const SampleArrays& s, int i, const PoseF& T) {
  const V3 arm = turned(T, position(s, i));
  return {arm, {arm.x + T.t[0], arm.y + T.t[1], arm.z + T.t[2]}, turned(T, direction(s, i))};
}

struct Measured {
  int u, v, pixel;  // pixel -1: outside
  float z;          // 0: nothing
};
Measured measured(const DepthMap& m, float u, float v) {
  const bool inside = u >= -0.5f && v >= -0.5f && u < static_cast<float>(m.width) - 0.5f &&
                      v < static_cast<float>(m.height) - 0.5f;
  if (!inside) return {0, 0, -1, 0};
  const int iu = static_cast<int>(u + 0.5f), iv = static_cast<int>(v + 0.5f);
  const int pixel = iv * m.stride + iu;
  return {iu, iv, pixel, m.depth_mm[pixel]};
}
Measured measured(const DepthMap& m, const V3& p) {
  const float iz = 1 / p.z;
  return measured(m, (p.x * iz) * m.camera.fx + m.camera.cx,
                  (p.y * iz) * m.camera.fy + m.camera.cy);
}

// From a point of the model to the measured one, along the model's normal.
float along_normal(const DepthMap& m, const Measured& at, const V3& p, const V3& n) {
  const V3 q{((static_cast<float>(at.u) - m.camera.cx) * m.camera.inverse_fx) * at.z,
             ((static_cast<float>(at.v) - m.camera.cy) * m.camera.inverse_fy) * at.z, at.z};
  return dot(n, {q.x - p.x, q.y - p.y, q.z - p.z});
}

float geman_mcclure(float residual, float scale) {
  const float k = 1 + (residual * residual) * (4 / (scale * scale));
  return 1 / (k * k);
}

// The partial sums of weighted least squares.
struct PartialSums {
  float H[21][kPoseLanes] = {}, g[6][kPoseLanes] = {}, cost[kPoseLanes] = {};
  int count = 0;

  void add(int sample, const V3& arm, const V3& n, float r, float w) {
    const V3 turn = cross(arm, n);
    const float J[6] = {turn.x, turn.y, turn.z, n.x, n.y, n.z};
    const int lane = sample % kPoseLanes;
    int k = 0;
    for (int column = 0; column < 6; ++column) {
      const float weighted = w * J[column];
      for (int row = column; row < 6; ++row) H[k++][lane] += weighted * J[row];
      g[column][lane] += weighted * r;
    }
    cost[lane] += (w * r) * r;
    ++count;
  }
  void into(EquationSums& out) const {
    for (int k = 0; k < 21; ++k) out.H[k] += lane_sum(H[k]);
    for (int k = 0; k < 6; ++k) out.g[k] += lane_sum(g[k]);
    out.cost += lane_sum(cost);
    out.count += count;
  }
};

void look_at_surface(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                     SurfaceLook& out) {
  for (int i = 0; i < surface.count; ++i) {
    const Seen s = seen(surface, i, T);
    const Measured m = measured(depth, s.p);
    out.pixel[i] = m.pixel;
    out.offset_mm[i] = m.z > 0 ? m.z - s.p.z : kNotMeasured;
    out.residual_mm[i] = m.z > 0 ? along_normal(depth, m, s.p, s.d) : kNotMeasured;
  }
}

void surface_equations(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                       float gate_mm, EquationSums& out) {
  PartialSums sums;
  for (int i = 0; i < surface.count; ++i) {
    const Seen s = seen(surface, i, T);
    const Measured m = measured(depth, s.p);
    if (!(m.z > 0) || !(dot(s.d, s.p) < 0)) continue;
    const float r = 0 - along_normal(depth, m, s.p, s.d);
    if (std::fabs(r) <= gate_mm && std::fabs(m.z - s.p.z) <= 3 * gate_mm)
      sums.add(i, s.arm, s.d, r, geman_mcclure(r, gate_mm));
  }
  sums.into(out);
}

// Cosine between a model normal at p and the normal measured there; 1 where none was.
float normal_agreement(const DepthMap& m, int pixel, const V3& p, const V3& n, float inverse_norm) {
  if (!m.normal_valid[pixel]) return 1;
  const float x = m.normal_x[pixel], y = m.normal_y[pixel];
  const float z = 0 - std::sqrt(max((1 - x * x) - y * y, 0));
  // Turned as the z axis is into the ray (Rodrigues): axis (-ray.y, ray.x, 0).
  const V3 ray{p.x * inverse_norm, p.y * inverse_norm, p.z * inverse_norm};
  const V3 across{ray.x * z, ray.y * z, 0 - (ray.y * y + ray.x * x)};
  const float k = 1 / (1 + ray.z);
  const V3 turned_normal{(x + across.x) + (ray.x * across.z) * k,
                         (y + across.y) + (ray.y * across.z) * k,
                         (z + across.z) - (ray.y * across.y + ray.x * across.x) * k};
  return dot(n, turned_normal);
}

void surface_agreement(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                       const SurfaceTolerance& tolerance, const float (&from)[3],
                       SurfaceAgreement& out) {
  out = {};
  float supported[kPoseLanes] = {}, explained[kPoseLanes] = {};
  const float narrowing = 1 / (16 * tolerance.fit_mm * tolerance.fit_mm);
  const float normal_scale = 1 / (tolerance.normal_cos_to - tolerance.normal_cos_from);
  for (int i = 0; i < surface.count; ++i) {
    const Seen s = seen(surface, i, T);
    const Measured m = measured(depth, s.p);
    if (!(m.z > 0)) continue;
    const float r = along_normal(depth, m, s.p, s.d);
    if (m.z < s.p.z && r > tolerance.conflict_mm) {
      ++out.hidden;
    } else if (m.z > s.p.z && r < -tolerance.conflict_mm) {
      ++out.contradicted;
    } else {
      ++out.agreeing;
      const float q = max(1 - (r * r) * narrowing, 0), q2 = q * q, q4 = q2 * q2;
      const float inverse_norm = 1 / std::sqrt(dot(s.p, s.p));
      const float facing_alike = normal_agreement(depth, m.pixel, s.p, s.d, inverse_norm);
      const float alike = min(
          max((facing_alike - tolerance.normal_cos_from) * normal_scale, tolerance.normals_min), 1);
      const float support = (q4 * q4) * alike;
      const V3 n = direction(surface, i);
      const float facing = 0 - dot(s.d, s.p) * inverse_norm,
                  facing_then = max(dot(n, {from[0], from[1], from[2]}), 0.05f);
      supported[i % kPoseLanes] += support;
      explained[i % kPoseLanes] += support * min(max(facing / facing_then, 0), 2);
    }
  }
  out.supported = lane_sum(supported);
  out.explained = lane_sum(explained);
}

void place_contour(const SampleArrays& contour, const PoseF& T, const GrayMap& gray,
                   const DepthMap& depth, float margin_px, float hidden_mm, ContourPlaces& out) {
  const PinholeF& camera = gray.camera;
  const float u_max = static_cast<float>(gray.width - 2) - margin_px,
              v_max = static_cast<float>(gray.height - 2) - margin_px;
  const float length_min = (1e-12f * camera.fx) * camera.fx;
  for (int i = 0; i < contour.count; ++i) {
    const Seen s = seen(contour, i, T);
    const float iz = 1 / s.p.z, a = s.p.x * iz, b = s.p.y * iz;
    const float u = a * camera.fx + camera.cx, v = b * camera.fy + camera.cy;
    // The edge's direction in the image: derivative of the projection.
    const float along_u = camera.fx * (s.d.x - a * s.d.z),
                along_v = camera.fy * (s.d.y - b * s.d.z);
    const float length2 = along_u * along_u + along_v * along_v;
    const float inverse = 1 / std::sqrt(max(length2, length_min));
    const float z = measured(depth, s.p).z;
    const bool visible = length2 > length_min && u >= margin_px && v >= margin_px && u <= u_max &&
                         v <= v_max && !(z > 0 && z < s.p.z - hidden_mm);
    out.u[i] = u;
    out.v[i] = v;
    out.normal_u[i] = 0 - along_v * inverse;
    out.normal_v[i] = along_u * inverse;
    out.x[i] = s.p.x;
    out.y[i] = s.p.y;
    out.z[i] = s.p.z;
    out.visible[i] = visible ? -1 : 0;
  }
}

float gray_at(const GrayMap& gray, float u, float v) {
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
  const std::uint8_t* p = gray.pixels + iv * gray.stride + iu;
  const std::uint8_t* q = p + gray.stride;
  const float p0 = p[0], p1 = p[1], q0 = q[0], q1 = q[1];
  const float top = p0 + fu * (p1 - p0), bottom = q0 + fu * (q1 - q0);
  return top + fv * (bottom - top);
}

void match_edges(const ContourPlaces& places, int count, const GrayMap& gray, int range_px,
                 ContourEdges& out) {
  const int steps = 2 * range_px + 3;
  for (int i = 0; i < count; ++i) {
    out.found[i] = 0;
    out.offset_px[i] = 0;
    if (!places.visible[i]) continue;
    float profile[2 * kEdgeRangePxMax + 3];
    for (int k = 0; k < steps; ++k) {
      const float away = static_cast<float>(k - range_px - 1);
      profile[k] = gray_at(gray, places.u[i] + away * places.normal_u[i],
                           places.v[i] + away * places.normal_v[i]);
    }
    const auto contrast = [&](int k) { return std::fabs(profile[k + 1] - profile[k - 1]); };
    float best = 0;
    for (int k = 1; k + 1 < steps; ++k) {
      const float c = contrast(k), away = static_cast<float>(k - range_px - 1);
      const float share = away / static_cast<float>(range_px + 1);
      const float value = min(c, kContrastMax) * (1 - (kFarEdgeLoss * share) * share);
      if (!(c >= kContrastMin) || !(value > best)) continue;
      best = value;
      out.found[i] = -1;
      out.offset_px[i] = away;
      if (k == 1 || k + 2 == steps) continue;
      // The vertex of the parabola through three contrasts.
      const float before = contrast(k - 1), after = contrast(k + 1);
      const float bend = (before + after) - (c + c);
      if (bend < -1e-3f)
        out.offset_px[i] = away + min(max((0.5f * (before - after)) / bend, -0.5f), 0.5f);
    }
  }
}

void contour_equations(const ContourPlaces& places, const ContourEdges& edges, int count,
                       const float (&centre)[3], const PinholeF& camera, float range_px,
                       EquationSums& out) {
  PartialSums sums;
  for (int i = 0; i < count; ++i) {
    if (!edges.found[i]) continue;
    const V3 p{places.x[i], places.y[i], places.z[i]};
    const float iz = 1 / p.z;
    // Derivative of the offset along the normal by the point in the camera.
    const float a = (places.normal_u[i] * camera.fx) * iz,
                b = (places.normal_v[i] * camera.fy) * iz;
    const V3 n{a, b, 0 - (a * p.x + b * p.y) * iz};
    const float r = 0 - edges.offset_px[i];
    sums.add(i, {p.x - centre[0], p.y - centre[1], p.z - centre[2]}, n, r,
             geman_mcclure(r, range_px));
  }
  sums.into(out);
}

int nearest_direction(const SampleArrays& directions, const float (&d)[3]) {
  int best = 0;
  float best_cosine = -2;
  for (int i = 0; i < directions.count; ++i) {
    const float cosine = dot(position(directions, i), {d[0], d[1], d[2]});
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best = i;
    }
  }
  return best;
}

}  // namespace

PoseKernels pose_kernels_scalar() {
  return {look_at_surface, surface_equations, surface_agreement, place_contour,
          match_edges,     contour_equations, nearest_direction};
}

}  // namespace binpick::simd
