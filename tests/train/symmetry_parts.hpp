// Parts with known symmetries, made of prisms and turned solids.
#pragma once

#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {

// A solid of the same outline, a regular polygon, at each of the given (radius, z); closed at both
// ends. The corners stand at `begin_rad` + k turns / sides.
inline void add_turned(Mesh& mesh, const std::vector<Vec2>& profile, int sides,
                       double begin_rad = 0) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  const auto n = static_cast<std::uint32_t>(sides);
  for (const Vec2& p : profile) {
    for (int k = 0; k < sides; ++k) {
      const double a = begin_rad + 2 * kPi * k / sides;
      mesh.vertices_mm.push_back(
          Vec3(p.x() * std::cos(a), p.x() * std::sin(a), p.y()).cast<float>());
    }
  }
  const auto low = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.push_back(Vec3(0, 0, profile.front().y()).cast<float>());
  mesh.vertices_mm.push_back(Vec3(0, 0, profile.back().y()).cast<float>());
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      const std::uint32_t a = first + r * n + k, b = first + r * n + next;
      mesh.triangles.push_back({a, b, b + n});
      mesh.triangles.push_back({a, b + n, a + n});
    }
    mesh.triangles.push_back({low, first + next, first + k});
    mesh.triangles.push_back(
        {low + 1, first + (rings - 1) * n + k, first + (rings - 1) * n + next});
  }
}

inline Mesh turned(const std::vector<Vec2>& profile, int sides) {
  Mesh mesh;
  add_turned(mesh, profile, sides);
  return mesh;
}

// 60 x 40 x 3 with a square hole whose middle is off by (dx, dy).
inline Mesh holed_plate(double dx, double dy) {
  Mesh mesh;
  add_block(mesh, {-30, -20, 0}, {dx - 5, 20, 3});
  add_block(mesh, {dx + 5, -20, 0}, {30, 20, 3});
  add_block(mesh, {dx - 5, -20, 0}, {dx + 5, dy - 5, 3});
  add_block(mesh, {dx - 5, dy + 5, 0}, {dx + 5, 20, 3});
  return mesh;
}

// A hexagonal head on a shaft with rings for its thread.
inline Mesh ringed_bolt() {
  Mesh mesh;
  add_turned(mesh, {{9, -18}, {9, -11}}, 6);
  std::vector<Vec2> shaft;
  for (int i = 0; i <= 20; ++i) shaft.emplace_back(i % 2 == 0 ? 5 : 4.3, -11 + 1.5 * i);
  add_turned(mesh, shaft, 24);
  return mesh;
}

// Legs of 50 and 30 mm, 24 mm wide, one corner of the longer leg cut off.
inline Mesh uneven_bracket() {
  Mesh mesh;
  add_block(mesh, {0, 0, 0}, {40, 24, 4});
  add_block(mesh, {40, 0, 0}, {50, 14, 4});
  add_block(mesh, {0, 0, 4}, {4, 24, 30});
  return mesh;
}

}  // namespace binpick::train
