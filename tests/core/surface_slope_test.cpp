#include "simd/surface_slope.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "binpick/geometry/angle.hpp"

namespace binpick {
namespace {

constexpr int kSize = 41;

struct DepthImage {
  std::vector<float> pixels = std::vector<float>(kSize * kSize);
  float& at(int x, int y) { return pixels[static_cast<std::size_t>(y * kSize + x)]; }
  ImageView<const float> view() const { return {pixels.data(), kSize, kSize, kSize}; }
};

// The plane through the point that pixel (x, y) shows at z_mm, exactly as the camera sees it.
DepthImage plane(const CameraIntrinsics& camera, const Vec3& normal, int x, int y, double z_mm) {
  const double height = normal.dot(camera.unproject(x, y, z_mm));
  DepthImage image;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const Vec3 ray = camera.unproject(u, v, 1);
      image.at(u, v) = static_cast<float>(height / normal.dot(ray));
    }
  }
  return image;
}

Vec3 in_ray_frame(const CameraIntrinsics& camera, const Vec3& normal, int x, int y) {
  return rotation_between(Vec3::UnitZ(), camera.ray(x, y)).transpose() * normal;
}

double angle_deg(const RayNormal& n, const Vec3& expected) {
  const double x = static_cast<double>(n.x), y = static_cast<double>(n.y);
  const Vec3 found(x, y, -std::sqrt(std::max(0.0, 1 - x * x - y * y)));
  return std::acos(std::min(1.0, found.dot(expected))) / kDegree;
}

// A step between two areas; where(x, y) is true on the near one.
template <class Where>
DepthImage step_image(float near_mm, float far_mm, Where&& where) {
  DepthImage image;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) image.at(x, y) = where(x, y) ? near_mm : far_mm;
  }
  return image;
}

TEST(RayNormal, IsExactOnPlanesOnTheAxis) {
  const CameraIntrinsics camera{kSize, kSize, 900, 900, 20, 20};
  for (const Vec3& slope : {Vec3(0, 0, -1), Vec3(0.5, 0, -1), Vec3(0, -0.7, -1), Vec3(-1, 1, -1)}) {
    const Vec3 normal = slope.normalized();
    const RayNormal n = fit_ray_normal(plane(camera, normal, 20, 20, 600).view(), camera, 20, 20);
    ASSERT_TRUE(n.valid);
    EXPECT_LT(angle_deg(n, normal), 0.2) << normal.transpose();
  }
}

TEST(RayNormal, IsExactOnPlanesOffTheAxis) {
  // The principal point far outside: the rays lean by up to 37 degrees, and the pixels are not
  // square.
  for (const Vec2& centre : {Vec2(-500, 20), Vec2(20, 620), Vec2(-400, -300)}) {
    const CameraIntrinsics camera{kSize, kSize, 900, 800, centre.x(), centre.y()};
    for (const Vec3& slope : {Vec3(0, 0, -1), Vec3(0.3, 0.2, -1), Vec3(-0.4, 0.1, -1)}) {
      const Vec3 normal = slope.normalized();
      const DepthImage image = plane(camera, normal, 20, 20, 600);
      const RayNormal n = fit_ray_normal(image.view(), camera, 20, 20);
      ASSERT_TRUE(n.valid);
      EXPECT_LT(angle_deg(n, in_ray_frame(camera, normal, 20, 20)), 0.2) << normal.transpose();
    }
  }
}

TEST(RayNormal, OfASurfaceAcrossTheRayFacesTheCamera) {
  const CameraIntrinsics camera{kSize, kSize, 700, 700, -300, 250};
  const Vec3 normal = -camera.ray(18, 22);
  const RayNormal n = fit_ray_normal(plane(camera, normal, 18, 22, 500).view(), camera, 18, 22);
  ASSERT_TRUE(n.valid);
  EXPECT_NEAR(0, n.x, 2e-3);
  EXPECT_NEAR(0, n.y, 2e-3);
}

TEST(RayNormal, LeavesOutAnotherSurfaceAndMissingDepth) {
  const CameraIntrinsics camera{kSize, kSize, 900, 900, 20, 20};
  const Vec3 normal = Vec3(0.4, 0.1, -1).normalized();
  DepthImage image = plane(camera, normal, 20, 20, 600);
  for (int y = 0; y < kSize; ++y) {
    image.at(22, y) += 20;  // beyond kSameSurfaceRatio of the depth
    image.at(18, y) = 0;
  }
  const RayNormal n = fit_ray_normal(image.view(), camera, 20, 20);
  ASSERT_TRUE(n.valid);
  EXPECT_LT(angle_deg(n, normal), 0.2);
}

TEST(RayNormal, IsInvalidWithoutEnoughOfASurface) {
  const CameraIntrinsics camera{kSize, kSize, 900, 900, 20, 20};
  DepthImage image;
  EXPECT_FALSE(fit_ray_normal(image.view(), camera, 20, 20).valid);
  image.at(20, 20) = 600;
  EXPECT_FALSE(fit_ray_normal(image.view(), camera, 20, 20).valid);
  for (int x = 0; x < kSize; ++x) image.at(x, 20) = 600;  // a line holds no plane
  EXPECT_FALSE(fit_ray_normal(image.view(), camera, 20, 20).valid);
}

TEST(DepthStep, PointsToTheFarSide) {
  const DepthImage right = step_image(500, 520, [](int x, int) { return x <= 20; });
  const DepthStep r = depth_step(right.view(), 20, 10);
  ASSERT_TRUE(r.edge);
  EXPECT_GT(r.gx, 0);
  EXPECT_EQ(0, r.gy);
  const DepthImage up = step_image(500, 520, [](int, int y) { return y >= 20; });
  const DepthStep u = depth_step(up.view(), 10, 20);
  ASSERT_TRUE(u.edge);
  EXPECT_EQ(0, u.gx);
  EXPECT_LT(u.gy, 0);
  const DepthImage corner = step_image(500, 520, [](int x, int y) { return x <= 20 && y <= 20; });
  const DepthStep c = depth_step(corner.view(), 20, 20);
  ASSERT_TRUE(c.edge);
  EXPECT_GT(c.gx, 0);
  EXPECT_FLOAT_EQ(c.gx, c.gy);
}

TEST(DepthStep, IsOnTheNearSideOnly) {
  const DepthImage image = step_image(500, 520, [](int x, int) { return x <= 20; });
  for (int x = 1; x + 1 < kSize; ++x) EXPECT_EQ(x == 20, depth_step(image.view(), x, 10).edge) << x;
}

TEST(DepthStep, TakesMissingDepthForFar) {
  for (const float missing : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    const DepthImage image = step_image(500, missing, [](int x, int) { return x <= 20; });
    const DepthStep step = depth_step(image.view(), 20, 10);
    ASSERT_TRUE(step.edge);
    EXPECT_GT(step.gx, 0);
    EXPECT_FALSE(depth_step(image.view(), 21, 10).edge);
  }
}

TEST(DepthStep, NeedsMoreThanTheStatedShareOfTheDepth) {
  const auto edge_at = [](float step_mm) {
    const DepthImage image = step_image(500, 500 + step_mm, [](int x, int) { return x <= 20; });
    return depth_step(image.view(), 20, 10).edge;
  };
  EXPECT_FALSE(edge_at(500 * kDepthEdgeRatio * 0.95f));
  EXPECT_TRUE(edge_at(500 * kDepthEdgeRatio * 1.05f));
}

TEST(DepthStep, IsNoSteepSlope) {
  const CameraIntrinsics camera{kSize, kSize, 900, 900, 20, 20};
  for (const double degrees : {45.0, 60.0, 70.0}) {
    const double a = degrees * kDegree;
    const DepthImage image = plane(camera, {std::sin(a), 0, -std::cos(a)}, 20, 20, 600);
    for (int x = 1; x + 1 < kSize; ++x) EXPECT_FALSE(depth_step(image.view(), x, 20).edge);
  }
}

TEST(DepthStep, StaysWithinItsUnits) {
  const DepthImage image = step_image(100, 5000, [](int x, int y) { return (x * 7 + y * 5) % 3; });
  for (int y = 1; y + 1 < kSize; ++y) {
    for (int x = 1; x + 1 < kSize; ++x) {
      const DepthStep s = depth_step(image.view(), x, y);
      EXPECT_LE(std::fabs(s.gx), 16);
      EXPECT_LE(std::fabs(s.gy), 16);
    }
  }
}

}  // namespace
}  // namespace binpick
