#include "simulation/pile.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <future>

#include "parts.hpp"
#include "simulation/simplified_mesh.hpp"

namespace binpick::simulation {
namespace {

constexpr double kDiameterMm = 80;  // what training scales every part to
// Of the diameter. Parts must not sink into each other, the floor and the walls by more than the
// first; each that is lowered by the second must touch what carries it.
constexpr double kOverlapMax = 0.015;
constexpr double kGapMax = 0.02;

// A part with points all over its surface.
struct Solid {
  TriangleMesh mesh;
  std::vector<Vec3> points;
  CollisionShape shape;
};

Solid solid_of(TriangleMesh mesh) {
  const double scale = kDiameterMm / diameter(mesh);
  for (Vec3& v : mesh.vertices) v *= scale;
  Solid out;
  out.mesh = simplified(mesh, 500);
  out.shape.pieces = convex_pieces(out.mesh, ConvexPiecesParams{});
  const Bounds box = bounds(out.mesh);
  out.shape.radius_mm = (box.max - box.min).norm() / 2;
  constexpr double kSpacingMm = 3;
  for (const Triangle& t : out.mesh.triangles) {
    const Vec3 a = out.mesh.vertices[t[0]];
    const Vec3 u = out.mesh.vertices[t[1]] - a, v = out.mesh.vertices[t[2]] - a;
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int steps = static_cast<int>(std::ceil(longest / kSpacingMm));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) out.points.push_back(a + (i * u + j * v) / steps);
    }
  }
  return out;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm();
}

double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  const auto within = [&](const Vec3& from, const Vec3& to) {
    return normal.cross(to - from).dot(p - from) >= 0;
  };
  if (within(a, b) && within(b, c) && within(c, a)) return std::abs(normal.dot(p - a));
  return std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// How far below the surface a point lies; 0 outside.
double depth_in(const TriangleMesh& mesh, const Bounds& box, const Vec3& p) {
  if ((p.array() < box.min.array()).any() || (p.array() > box.max.array()).any()) return 0;
  if (winding_number(mesh, p) < 0.5) return 0;
  double least = kDiameterMm;
  for (const Triangle& t : mesh.triangles) {
    least = std::min(least, distance_to_triangle(p, mesh.vertices[t[0]], mesh.vertices[t[1]],
                                                 mesh.vertices[t[2]]));
  }
  return least;
}

// The deepest that a part's points lie in the other part.
double depth_in_other(const Solid& solid, const Pose& part, const Pose& other) {
  const Bounds box = bounds(solid.mesh);
  const Pose T_other_part = other.inverse() * part;
  double deepest = 0;
  if (T_other_part.t_mm.norm() > 2 * solid.shape.radius_mm) return 0;
  for (const Vec3& p : solid.points) {
    deepest = std::max(deepest, depth_in(solid.mesh, box, T_other_part * p));
  }
  return deepest;
}

// The deepest that a part's points lie below the floor or in a wall.
double depth_in_bin(const Solid& solid, const Pose& part, const BinSize& bin) {
  double deepest = 0;
  for (const Vec3& point : solid.points) {
    const Vec3 p = part * point;
    deepest = std::max(deepest, -p.z());
    if (p.z() > bin.height - kOverlapMax * kDiameterMm) continue;  // it may lie on the rim
    deepest =
        std::max({deepest, std::abs(p.x()) - bin.length / 2, std::abs(p.y()) - bin.width / 2});
  }
  return deepest;
}

void expect_at_rest_and_apart(const Solid& solid, std::size_t count, std::uint64_t seed) {
  const BinSize bin;
  const std::vector<PlacedPart> placed =
      make_pile({solid.shape}, std::vector<std::size_t>(count, 0), bin, Rng(seed));
  EXPECT_GE(placed.size() + 2, count);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Pose& part = placed[i].T_world_obj;
    Pose lowered = part;
    lowered.t_mm.z() -= kGapMax * kDiameterMm;
    double overlap = depth_in_bin(solid, part, bin);
    bool carried = depth_in_bin(solid, lowered, bin) > overlap;
    for (std::size_t j = 0; j < placed.size(); ++j) {
      if (j == i) continue;
      const Pose& other = placed[j].T_world_obj;
      overlap = std::max(overlap, depth_in_other(solid, part, other));
      carried = carried || depth_in_other(solid, lowered, other) > 0 ||
                depth_in_other(solid, other, lowered) > 0;
    }
    EXPECT_LT(overlap, kOverlapMax * kDiameterMm) << "part " << i;
    EXPECT_TRUE(carried) << "part " << i;
  }
}

TEST(Pile, HubsComeToRestApartFromEachOther) {
  expect_at_rest_and_apart(solid_of(make_hub()), 12, 1);
}

TEST(Pile, BoltsComeToRestApartFromEachOther) {
  expect_at_rest_and_apart(solid_of(make_bolt()), 20, 2);
}

TEST(Pile, IsTheSameBesideAnother) {
  const Solid solid = solid_of(make_hub());
  const auto pile = [&] {
    return make_pile({solid.shape}, std::vector<std::size_t>(6, 0), BinSize{}, Rng(3));
  };
  const std::vector<PlacedPart> alone = pile();
  auto first = std::async(std::launch::async, pile);
  auto second = std::async(std::launch::async, pile);
  for (const std::vector<PlacedPart>& other : {first.get(), second.get()}) {
    ASSERT_EQ(other.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(other[i].T_world_obj.R, alone[i].T_world_obj.R);
      EXPECT_EQ(other[i].T_world_obj.t_mm, alone[i].T_world_obj.t_mm);
    }
  }
}

TEST(Bolt, IsAClosedSolidWithAFineThread) {
  const TriangleMesh bolt = make_bolt();
  EXPECT_TRUE(is_closed(bolt));
  EXPECT_GT(bolt.triangles.size(), 13000u);
  EXPECT_LT(bolt.triangles.size(), 15000u);
  const Bounds box = bounds(bolt);
  EXPECT_NEAR(box.max.z() - box.min.z(), 46.4, 1e-6);
}

}  // namespace
}  // namespace binpick::simulation
