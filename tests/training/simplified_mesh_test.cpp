#include "simulation/simplified_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

// A sphere of radius 10 from rings.
TriangleMesh sphere(int rings, int sides) {
  TriangleMesh mesh;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const double polar = kPi * r / rings;
      const double turn = 2 * kPi * s / sides;
      mesh.add_vertex({10 * std::sin(polar) * std::cos(turn), 10 * std::sin(polar) * std::sin(turn),
                       10 * std::cos(polar)});
    }
  }
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const int a = r * sides + s;
      const int b = r * sides + (s + 1) % sides;
      mesh.add_triangle(a, a + sides, b);
      mesh.add_triangle(b, a + sides, b + sides);
    }
  }
  return mesh;
}

TEST(SimplifiedMesh, LeavesSmallMeshesAlone) {
  const TriangleMesh mesh = sphere(10, 20);
  const TriangleMesh same = simplified(mesh, mesh.triangles.size());
  EXPECT_EQ(same.triangles, mesh.triangles);
  EXPECT_EQ(same.vertices, mesh.vertices);
}

TEST(SimplifiedMesh, HasNoMoreTrianglesThanAskedForAndKeepsTheShape) {
  const TriangleMesh mesh = sphere(150, 300);
  const TriangleMesh less = simplified(mesh, 5000);
  EXPECT_LE(less.triangles.size(), 5000u);
  EXPECT_GE(less.triangles.size(), 2000u) << "coarser than it has to be";
  for (const auto& v : less.vertices) EXPECT_NEAR(v.norm(), 10, 0.1);
  EXPECT_NEAR(std::abs(signed_volume(less)), 4 / 3.0 * kPi * 1000, 50);
}

}  // namespace
}  // namespace binpick::simulation
