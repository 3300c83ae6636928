// The diameter that is found without all pairs, against all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "train/tetrahedron.hpp"

namespace binpick::train {
namespace {

double diameter_by_all_pairs(const std::vector<Eigen::Vector3f>& points) {
  double square = 0;
  for (const auto& a : points) {
    for (const auto& b : points) {
      square = std::max(square, (a.cast<double>() - b.cast<double>()).squaredNorm());
    }
  }
  return std::sqrt(square);
}

TEST(MeshBounds, GivesBoxAndDiameter) {
  const MeshBounds bounds = mesh_bounds(tetrahedron());
  EXPECT_EQ(bounds.min_mm, Vec3(0, 0, 0));
  EXPECT_EQ(bounds.max_mm, Vec3(30, 40, 10));
  EXPECT_DOUBLE_EQ(bounds.diameter_mm, 50);
}

TEST(MeshBounds, FindsTheDiameterOfPointClouds) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (int shape = 0; shape < 4; ++shape) {
    Mesh mesh;
    for (int i = 0; i < 4000; ++i) {
      Eigen::Vector3f x(normal(random), normal(random), normal(random));
      if (shape == 1) x.normalize();  // every point is as far out as any other
      if (shape == 2) x = x.cwiseMax(-1.0f).cwiseMin(1.0f);
      if (shape == 3) x = Eigen::Vector3f(x.x(), x.y(), 0).normalized();
      mesh.vertices_mm.push_back(20 * x);
    }
    const double exact = diameter_by_all_pairs(mesh.vertices_mm);
    const double found = mesh_bounds(mesh).diameter_mm;
    EXPECT_LE(found, exact * (1 + 1e-12));
    EXPECT_GE(found, exact * (1 - 1e-3)) << "shape " << shape;
  }
}

TEST(MeshBounds, IsExactForFewCandidates) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(-10, 10);
  for (int run = 0; run < 50; ++run) {
    Mesh mesh;
    for (int i = 0; i < 40; ++i) {
      mesh.vertices_mm.emplace_back(uniform(random), uniform(random), uniform(random));
    }
    EXPECT_DOUBLE_EQ(mesh_bounds(mesh).diameter_mm, diameter_by_all_pairs(mesh.vertices_mm));
  }
}

}  // namespace
}  // namespace binpick::train
