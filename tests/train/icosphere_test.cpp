// The sphere of viewpoints against what is known of the icosahedron and of Euler's formula.
#include "train/icosphere.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "binpick/geometry/angle.hpp"

namespace binpick::train {
namespace {

constexpr int kSubdivisions = 4;
constexpr double kRadToDeg = 1 / kDegree;

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kRadToDeg;
}

// Angle from each vertex of subdivision s to its nearest neighbour.
std::vector<double> neighbour_angles_deg(const Icosphere& sphere, int s) {
  std::vector<double> out;
  for (int a = 0; a < sphere.counts[s]; ++a) {
    double nearest = 180;
    for (int b = 0; b < sphere.counts[s]; ++b) {
      if (b != a) nearest = std::min(nearest, angle_deg(sphere.vertices[a], sphere.vertices[b]));
    }
    out.push_back(nearest);
  }
  return out;
}

TEST(Icosphere, Has12Then42Then162Then642Vertices) {
  EXPECT_EQ(make_icosphere(1).counts, std::vector<int>({12}));
  const Icosphere sphere = make_icosphere(kSubdivisions);
  EXPECT_EQ(sphere.counts, std::vector<int>({12, 42, 162, 642}));
  EXPECT_EQ(sphere.vertices.size(), 642u);
}

TEST(Icosphere, HasVerticesOfUnitLengthThatAllDiffer) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  for (const Vec3& v : sphere.vertices) EXPECT_NEAR(v.norm(), 1, 1e-12);
  EXPECT_GT(std::ranges::min(neighbour_angles_deg(sphere, kSubdivisions - 1)), 5);
}

TEST(Icosphere, SplitsEachEdgeOnceSoThatEulersFormulaHolds) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  ASSERT_EQ(sphere.edges.size(), static_cast<std::size_t>(kSubdivisions) - 1);
  for (std::size_t s = 0; s < sphere.edges.size(); ++s) {
    const int vertices = sphere.counts[s], edges = static_cast<int>(sphere.edges[s].size());
    const int faces = 20 << (2 * s);
    EXPECT_EQ(2 * edges, 3 * faces) << "subdivision " << s;
    EXPECT_EQ(vertices - edges + faces, 2) << "subdivision " << s;
    EXPECT_EQ(sphere.counts[s + 1], vertices + edges);
    std::set<std::array<int, 2>> distinct;
    for (const auto& e : sphere.edges[s]) {
      ASSERT_NE(e[0], e[1]);
      ASSERT_TRUE(e[0] >= 0 && e[0] < vertices && e[1] >= 0 && e[1] < vertices);
      distinct.insert({std::min(e[0], e[1]), std::max(e[0], e[1])});
    }
    EXPECT_EQ(distinct.size(), sphere.edges[s].size());
  }
}

TEST(Icosphere, PutsEachMidpointInTheMiddleOfItsEdge) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  for (std::size_t s = 0; s < sphere.edges.size(); ++s) {
    for (std::size_t e = 0; e < sphere.edges[s].size(); ++e) {
      const auto& [a, b] = sphere.edges[s][e];
      const Vec3& mid = sphere.vertices[static_cast<std::size_t>(sphere.counts[s]) + e];
      EXPECT_LT((mid - (sphere.vertices[a] + sphere.vertices[b]).normalized()).norm(), 1e-12);
    }
  }
}

TEST(Icosphere, HalvesTheAngleBetweenNeighbours) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  // Midpoints on a sphere are not spread quite evenly: within 15 % of the halved angle.
  double expected_deg = 2 * std::atan(2 / (1 + std::sqrt(5.0))) * kRadToDeg;
  EXPECT_NEAR(expected_deg, 63.43, 0.01);
  for (int s = 0; s < kSubdivisions; ++s, expected_deg /= 2) {
    const std::vector<double> angles = neighbour_angles_deg(sphere, s);
    const auto [least, most] = std::ranges::minmax_element(angles);
    EXPECT_GT(*least, 0.85 * expected_deg) << "subdivision " << s;
    EXPECT_LT(*most, 1.15 * expected_deg) << "subdivision " << s;
  }
}

TEST(BalancedParents, GiveEachParentThreeOrFourChildren) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  for (int s = 0; s + 1 < kSubdivisions; ++s) {
    const std::vector<int> parents = balanced_parents(sphere, s);
    ASSERT_EQ(parents.size(), static_cast<std::size_t>(sphere.counts[s + 1]));
    std::vector<int> children(sphere.counts[s], 0);
    for (const int p : parents) ++children.at(p);
    for (const int c : children) EXPECT_TRUE(c == 3 || c == 4) << c << " at subdivision " << s;
    // Twelve vertices have five edges, the others six: at most twelve can go short.
    EXPECT_LE(std::ranges::count(children, 3), 12);
  }
}

TEST(BalancedParents, AreANearestVertexOfTheCoarserSphere) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  for (int s = 0; s + 1 < kSubdivisions; ++s) {
    const std::vector<int> parents = balanced_parents(sphere, s);
    for (int v = 0; v < sphere.counts[s + 1]; ++v) {
      double nearest = 180;
      for (int p = 0; p < sphere.counts[s]; ++p) {
        nearest = std::min(nearest, angle_deg(sphere.vertices[v], sphere.vertices[p]));
      }
      EXPECT_NEAR(angle_deg(sphere.vertices[v], sphere.vertices[parents[v]]), nearest, 1e-9);
    }
  }
}

TEST(BalancedParents, KeepAVertexThatBothSpheresShare) {
  const Icosphere sphere = make_icosphere(kSubdivisions);
  for (int s = 0; s + 1 < kSubdivisions; ++s) {
    const std::vector<int> parents = balanced_parents(sphere, s);
    for (int v = 0; v < sphere.counts[s]; ++v) EXPECT_EQ(parents[v], v);
  }
}

}  // namespace
}  // namespace binpick::train
