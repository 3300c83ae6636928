#include "overlay/overlay.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <set>
#include <tuple>

#include "overlay/outline.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

constexpr CameraIntrinsics kCamera{200, 160, 300, 300, 100, 80};

// A cube of 40 mm about the origin.
train::Mesh cube() {
  train::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.emplace_back(i & 1 ? 20.f : -20.f, i & 2 ? 20.f : -20.f, i & 4 ? 20.f : -20.f);
  }
  for (const auto& quad : {std::array{0u, 2u, 3u, 1u},
                           {4u, 5u, 7u, 6u},
                           {0u, 1u, 5u, 4u},
                           {2u, 6u, 7u, 3u},
                           {0u, 4u, 6u, 2u},
                           {1u, 3u, 7u, 5u}}) {
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
  }
  return mesh;
}

Pose straight_on(double distance_mm) {
  return {Mat3::Identity(), Vec3(0, 0, distance_mm)};
}

int coverage_at(const OutlineMask& mask, int u, int v) {
  const int x = u - mask.x, y = v - mask.y;
  if (x < 0 || y < 0 || x >= mask.width || y >= mask.height) return 0;
  return mask.coverage[static_cast<std::size_t>(y) * mask.width + x];
}

std::tuple<int, int, int> colour_at(const Picture& picture, int x, int y) {
  const std::uint8_t* p = picture.pixel(x, y);
  return {p[0], p[1], p[2]};
}

TEST(Outline, RunsAlongTheEdgesOfTheFrontFace) {
  const train::Mesh mesh = cube();
  OutlineDrawer drawer(mesh, kCamera);
  // The front face is at 300 mm: 20 mm are 20 px.
  const OutlineMask mask = drawer.draw(straight_on(320), 1.5);
  for (const auto& [u, v] : {std::pair{80, 80}, {120, 80}, {100, 60}, {100, 100}}) {
    EXPECT_GT(coverage_at(mask, u, v), 60) << u << ", " << v;
  }
  EXPECT_EQ(coverage_at(mask, 100, 80), 0) << "the middle of the face";
  EXPECT_EQ(coverage_at(mask, 74, 80), 0) << "outside";
}

TEST(Outline, ShowsTheCreaseBetweenVisibleFaces) {
  const train::Mesh mesh = cube();
  OutlineDrawer drawer(mesh, kCamera);
  // Turned by 45 degrees about the vertical: one edge faces the camera.
  const Pose pose{rotation_from_vector({0, 0.785398, 0}), Vec3(0, 0, 400)};
  const OutlineMask mask = drawer.draw(pose, 1.5);
  EXPECT_GT(coverage_at(mask, 100, 80), 60);
  EXPECT_EQ(coverage_at(mask, 92, 80), 0);
  EXPECT_EQ(coverage_at(mask, 108, 80), 0);
}

TEST(Outline, IsEmptyBehindTheCameraAndOutsideTheImage) {
  const train::Mesh mesh = cube();
  OutlineDrawer drawer(mesh, kCamera);
  EXPECT_TRUE(drawer.draw(straight_on(-300), 1.5).coverage.empty());
  EXPECT_TRUE(drawer.draw({Mat3::Identity(), Vec3(900, 0, 320)}, 1.5).coverage.empty());
}

TEST(Outline, IsCutOffAtTheImageBorder) {
  const train::Mesh mesh = cube();
  OutlineDrawer drawer(mesh, kCamera);
  const OutlineMask mask = drawer.draw({Mat3::Identity(), Vec3(-105, 0, 320)}, 1.5);
  EXPECT_EQ(mask.x, 0);
  EXPECT_GE(mask.y, 0);
  EXPECT_LE(mask.y + mask.height, kCamera.height);
  // 20 mm beyond the axis of the cube at 300 mm: u = 100 + (-105 + 20).
  EXPECT_GT(coverage_at(mask, 15, 80), 60);
}

class Overlay : public testing::Test {
 protected:
  Picture paint(OverlayStyle style, const Pose& pose) {
    return painter_.paint(background(), {{pose, &mesh_, 0.87, "cube", style}});
  }
  Picture background() const { return picture_from_gray({gray_.data(), 200, 160, 200}); }

  train::Mesh mesh_ = cube();
  std::vector<std::uint8_t> gray_ = std::vector<std::uint8_t>(200 * 160, 50);
  OverlayPainter painter_{kCamera};
};

TEST_F(Overlay, LeavesThePictureAloneWithoutItems) {
  EXPECT_EQ(painter_.paint(background(), {}).rgb, background().rgb);
}

TEST_F(Overlay, DrawsTruthThinAndWhiteWithoutText) {
  const Picture picture = paint(OverlayStyle::kTruth, straight_on(320));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto [r, g, b] = colour_at(picture, x, y);
      ASSERT_TRUE(r == g && g == b) << "a colour at " << x << ", " << y;
    }
  }
  EXPECT_GT(std::get<0>(colour_at(picture, 80, 80)), 90);
}

TEST_F(Overlay, MarksFalsePicksRedAndMissesAmber) {
  const Colour wrong = style_colour(OverlayStyle::kFalsePick, 0),
               miss = style_colour(OverlayStyle::kMiss, 0);
  const auto [r1, g1, b1] = colour_at(paint(OverlayStyle::kFalsePick, straight_on(320)), 80, 80);
  EXPECT_GT(r1 - g1, 30);
  EXPECT_GT(wrong.r, wrong.g);
  const auto [r2, g2, b2] = colour_at(paint(OverlayStyle::kMiss, straight_on(320)), 80, 80);
  EXPECT_GT(r2 - b2, 30);
  EXPECT_GT(g2 - b2, 30);
  EXPECT_GT(miss.g, miss.b);
}

TEST_F(Overlay, DrawsAxesWhereTheyPoint) {
  const Picture picture = paint(OverlayStyle::kInstance, straight_on(320));
  const auto [rx, gx, bx] = colour_at(picture, 112, 80);  // along +x: red
  EXPECT_GT(rx, gx + 80);
  const auto [ry, gy, by] = colour_at(picture, 100, 92);  // along +y, downwards: green
  EXPECT_GT(gy, ry + 80);
}

TEST_F(Overlay, SurvivesPosesOutOfSight) {
  for (const Vec3& t :
       {Vec3(0, 0, -300), Vec3(0, 0, 0), Vec3(0, 0, 10), Vec3(5000, 0, 300), Vec3(0, 0, 1e6)}) {
    EXPECT_EQ(paint(OverlayStyle::kInstance, {Mat3::Identity(), t}).width, 200) << t.transpose();
  }
}

TEST(InstanceColours, AreDistinctAndBright) {
  std::set<std::tuple<int, int, int>> seen;
  for (int i = 0; i < 40; ++i) {
    const Colour c = instance_colour(i);
    EXPECT_EQ(std::max({c.r, c.g, c.b}), 255);
    EXPECT_TRUE(seen.insert({c.r, c.g, c.b}).second) << i;
  }
}

TEST(DepthColours, AreBlackWithoutMeasurementAndRunFromRedToBlue) {
  std::vector<float> depth(100 * 4);
  for (int i = 0; i < 400; ++i) depth[i] = 500.f + static_cast<float>(i % 100);
  depth[0] = 0;
  depth[1] = std::numeric_limits<float>::quiet_NaN();
  const Picture picture = colour_map_depth({depth.data(), 100, 4, 100}, {});
  EXPECT_EQ(colour_at(picture, 0, 0), std::tuple(0, 0, 0));
  EXPECT_EQ(colour_at(picture, 1, 0), std::tuple(0, 0, 0));
  const auto [rn, gn, bn] = colour_at(picture, 5, 1);
  const auto [rf, gf, bf] = colour_at(picture, 85, 1);
  EXPECT_GT(rn, bn + 50) << "near is red";
  EXPECT_GT(bf, rf + 50) << "far is blue";
}

TEST(DepthColours, OfAnEmptyImageAreBlack) {
  const std::vector<float> depth(12, 0.f);
  for (const std::uint8_t v : colour_map_depth({depth.data(), 4, 3, 4}, {}).rgb) EXPECT_EQ(v, 0);
}

TEST(PictureFile, IsReadBackWithTheSameColours) {
  Picture picture{3, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
  const TemporaryFolder folder;
  const std::string path = folder.file("picture.png");
  write_png(picture, path);
  const cv::Mat back = cv::imread(path, cv::IMREAD_COLOR);
  ASSERT_EQ(back.cols, 3);
  EXPECT_EQ(back.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(back.at<cv::Vec3b>(1, 0), cv::Vec3b(3, 2, 1));
  EXPECT_THROW(write_png(picture, "/nowhere/picture.png"), std::runtime_error);
}

TEST(PictureCrop, KeepsAMarginInsideThePicture) {
  Picture picture{100, 80, std::vector<std::uint8_t>(100 * 80 * 3, 0)};
  picture.pixel(30, 20)[0] = 200;
  const Picture crop = crop_to_roi(picture, {30, 20, 50, 40}, 25);
  EXPECT_EQ(crop.width, 95);   // 5 to 100
  EXPECT_EQ(crop.height, 80);  // 0 to 80
  EXPECT_EQ(crop.pixel(25, 20)[0], 200);
  EXPECT_EQ(crop_to_roi(picture, {}, 10).width, 100);
}

}  // namespace
}  // namespace binpick::app
