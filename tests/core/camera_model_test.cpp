#include "binpick/geometry/camera_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace binpick {
namespace {

const CameraIntrinsics kCamera{640, 480, 800, 790, 317.3, 242.8};

TEST(CameraModel, UnprojectsWhatItProjects) {
  for (const Vec3& p : {Vec3(0, 0, 500), Vec3(120, -70, 430), Vec3(-200, 150, 900)}) {
    const Vec2 uv = kCamera.project(p);
    EXPECT_LT((kCamera.unproject(uv.x(), uv.y(), p.z()) - p).norm(), 1e-10);
    EXPECT_LT((kCamera.ray(uv.x(), uv.y()) - p.normalized()).norm(), 1e-12);
  }
  EXPECT_LT((kCamera.project({0, 0, 1}) - Vec2(317.3, 242.8)).norm(), 1e-12);
}

TEST(CameraModel, LevelSeesTheMeanOfItsBlock) {
  for (int level = 0; level <= 4; ++level) {
    const CameraIntrinsics coarse = kCamera.at_level(level);
    const int block = 1 << level;
    EXPECT_EQ(640 / block, coarse.width);
    EXPECT_EQ(480 / block, coarse.height);
    // The centre of the block that starts at (320, 160) is the centre of its coarse pixel.
    const double middle = (block - 1) / 2.0;
    const Vec3 p = kCamera.unproject(320 + middle, 160 + middle, 700);
    EXPECT_LT((coarse.project(p) - Vec2(320.0 / block, 160.0 / block)).norm(), 1e-9) << level;
  }
}

TEST(CameraModel, LevelsAddUp) {
  const CameraIntrinsics twice = kCamera.at_level(1).at_level(2), once = kCamera.at_level(3);
  EXPECT_NEAR(once.fx, twice.fx, 1e-12);
  EXPECT_NEAR(once.cx, twice.cx, 1e-12);
  EXPECT_NEAR(once.cy, twice.cy, 1e-12);
}

TEST(CameraModel, RefusesFocalLengthsThatAreNone) {
  EXPECT_TRUE(kCamera.valid());
  for (const double bad : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    CameraIntrinsics camera = kCamera;
    camera.fx = bad;
    EXPECT_FALSE(camera.valid()) << bad;
    camera = kCamera;
    camera.fy = bad;
    EXPECT_FALSE(camera.valid()) << bad;
  }
  CameraIntrinsics camera = kCamera;
  camera.cx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.valid());
}

}  // namespace
}  // namespace binpick
