// Lens distortion is removed from images as OpenCV does it, without mixing depths, and not at all
// where there is none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "binpick/frame/undistort_map.hpp"
#include "core/allocation_count.hpp"
#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const CameraIntrinsics kCamera{320, 240, 300, 305, 155.5, 124.25};

struct Lens {
  const char* what;
  LensDistortion lens;
};
const Lens kLenses[] = {
    {"barrel, 4 coefficients", {-0.3, 0.1, 0, 0}},
    {"pincushion, 4 coefficients", {0.25, -0.05, 0, 0}},
    {"tangential", {0, 0, 0.004, -0.003}},
    {"plumb bob, 5 coefficients", {-0.28, 0.2, 0.0006, -0.0004, -0.1}},
    {"rational, 8 coefficients", {0.4, -2.1, 0.0003, 0.0002, 1.3, 0.3, -2.0, 1.2}},
};

cv::Mat opencv_matrix() {
  return (cv::Mat_<double>(3, 3) << kCamera.fx, 0, kCamera.cx, 0, kCamera.fy, kCamera.cy, 0, 0, 1);
}
cv::Mat opencv_coefficients(const LensDistortion& l) {
  return (cv::Mat_<double>(1, 8) << l.k1, l.k2, l.p1, l.p2, l.k3, l.k4, l.k5, l.k6);
}

template <class T>
ImageView<T> view_of(std::vector<T>& pixels) {
  return {pixels.data(), kCamera.width, kCamera.height, kCamera.width};
}

// Smooth gray, and depth that falls off in steps.
struct Pictures {
  std::vector<std::uint8_t> gray;
  std::vector<float> depth;
  Pictures() {
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        gray.push_back(
            static_cast<std::uint8_t>(127.5 + 60 * std::sin(x / 9.0) + 60 * std::cos(y / 7.0)));
        depth.push_back((x / 20 + y / 15) % 2 == 0 ? 500.0f : 650.0f);
      }
    }
  }
};

TEST(LensDistortion, IsOpenCvs) {
  for (const Lens& c : kLenses) {
    SCOPED_TRACE(c.what);
    std::vector<cv::Point3d> points;
    for (int y = 0; y < kCamera.height; y += 13) {
      for (int x = 0; x < kCamera.width; x += 11)
        points.emplace_back((x - kCamera.cx) / kCamera.fx, (y - kCamera.cy) / kCamera.fy, 1);
    }
    std::vector<cv::Point2d> seen;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), opencv_matrix(),
                      opencv_coefficients(c.lens), seen);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2 p = c.lens.distort({points[i].x, points[i].y});
      EXPECT_NEAR(p.x() * kCamera.fx + kCamera.cx, seen[i].x, 1e-9);
      EXPECT_NEAR(p.y() * kCamera.fy + kCamera.cy, seen[i].y, 1e-9);
    }
  }
}

TEST(UndistortMap, GivesWhatOpenCvGives) {
  for (const Lens& c : kLenses) {
    SCOPED_TRACE(c.what);
    Pictures raw;
    std::vector<std::uint8_t> gray(raw.gray.size());
    std::vector<float> depth(raw.depth.size());
    Arena arena(UndistortMap::footprint(kCamera.width, kCamera.height));
    const UndistortMap map(c.lens, kCamera, arena);
    EXPECT_EQ(arena.used_bytes(), arena.size_bytes());
    map.intensity(view_of(raw.gray), view_of(gray));
    map.depth(view_of(raw.depth), view_of(depth));

    cv::Mat map_x, map_y, expected_gray, expected_depth;
    cv::initUndistortRectifyMap(opencv_matrix(), opencv_coefficients(c.lens), cv::Mat(),
                                opencv_matrix(), {kCamera.width, kCamera.height}, CV_32FC1, map_x,
                                map_y);
    cv::remap(cv::Mat(kCamera.height, kCamera.width, CV_8UC1, raw.gray.data()), expected_gray,
              map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::remap(cv::Mat(kCamera.height, kCamera.width, CV_32FC1, raw.depth.data()), expected_depth,
              map_x, map_y, cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
    int other_depth = 0;
    for (int i = 0; i < kCamera.width * kCamera.height; ++i) {
      const int x = i % kCamera.width, y = i / kCamera.width;
      const auto at = static_cast<std::size_t>(i);
      // OpenCV's fractions are 32nds of a pixel, these are 256ths.
      ASSERT_NEAR(gray[at], expected_gray.at<std::uint8_t>(y, x), 2) << x << "," << y;
      other_depth += depth[at] != expected_depth.at<float>(y, x);
    }
    // Places half-way between two pixels may be rounded either way.
    EXPECT_LT(other_depth, kCamera.width * kCamera.height / 200);
  }
}

TEST(UndistortMap, NeverMixesDepths) {
  Pictures raw;
  std::vector<float> depth(raw.depth.size());
  Arena arena(UndistortMap::footprint(kCamera.width, kCamera.height));
  const UndistortMap map({0.25, -0.05, 0, 0}, kCamera, arena);  // shows what is beyond the image
  map.depth(view_of(raw.depth), view_of(depth));
  EXPECT_THAT(depth, testing::Each(testing::AnyOf(0.0f, 500.0f, 650.0f)));
  EXPECT_EQ(depth.front(), 0) << "the corner lies outside of the raw image";
  EXPECT_NE(depth[static_cast<std::size_t>(120 * kCamera.width + 160)], 0);
}

TEST(UndistortMap, AllocatesNothingWhenUsed) {
  Pictures raw;
  std::vector<std::uint8_t> gray(raw.gray.size());
  std::vector<float> depth(raw.depth.size());
  Arena arena(UndistortMap::footprint(kCamera.width, kCamera.height));
  const UndistortMap map({-0.3, 0.1, 0, 0}, kCamera, arena);
  const auto before = allocation_count();
  map.intensity(view_of(raw.gray), view_of(gray));
  map.depth(view_of(raw.depth), view_of(depth));
  EXPECT_EQ(allocation_count(), before);
}

// Points that a distorting camera saw are found where a pinhole camera sees them.
TEST(Undistortion, OfAFrameFromFilesPutsPointsWhereAPinholeCameraSeesThem) {
  const TemporaryFolder folder;
  const LensDistortion lens{-0.28, 0.2, 0.0006, -0.0004, -0.1};
  cv::Mat gray(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(20));
  cv::Mat depth(kCamera.height, kCamera.width, CV_16UC1, cv::Scalar(7000));
  std::vector<Vec2> pinhole;
  for (int y = 20; y < kCamera.height; y += 40) {
    for (int x = 20; x < kCamera.width; x += 40) {
      const Vec2 seen =
          lens.distort({(x - kCamera.cx) / kCamera.fx, (y - kCamera.cy) / kCamera.fy});
      const cv::Point at(static_cast<int>(std::lround(seen.x() * kCamera.fx + kCamera.cx)),
                         static_cast<int>(std::lround(seen.y() * kCamera.fy + kCamera.cy)));
      cv::rectangle(gray, at - cv::Point(2, 2), at + cv::Point(2, 2), cv::Scalar(220), cv::FILLED);
      cv::rectangle(depth, at - cv::Point(2, 2), at + cv::Point(2, 2), cv::Scalar(5000),
                    cv::FILLED);
      pinhole.emplace_back(x, y);
    }
  }
  ASSERT_TRUE(cv::imwrite(folder.file("gray.png"), gray));
  ASSERT_TRUE(cv::imwrite(folder.file("depth.png"), depth));
  FrameCamera camera;
  camera.intrinsics = kCamera;
  camera.lens = lens;
  camera.depth_scale = 0.1;
  const LoadedFrame frame =
      load_frame_files(folder.file("depth.png"), folder.file("gray.png"), camera);
  EXPECT_THAT(frame.notes, Contains(HasSubstr("lens distortion is removed")));
  EXPECT_EQ(frame.depth_scale_mm, 0.1) << "depths are still whole numbers of it";
  for (const Vec2& p : pinhole) {
    const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
    EXPECT_NEAR(frame.view().depth_mm.at(x, y), 500, 1e-3) << x << "," << y;
    EXPECT_NEAR(frame.view().intensity.at(x, y), 220, 1) << x << "," << y;
    EXPECT_NEAR(frame.view().depth_mm.at(x, y + 7), 700, 1e-3) << x << "," << y;
  }
}

TEST(Undistortion, OfCoefficientsThatAreZeroChangesNothing) {
  const TemporaryFolder folder;
  const Pictures raw;
  const std::string path = folder.file("gray.png"), yaml = folder.file("camera.yaml");
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(kCamera.height, kCamera.width, CV_8UC1,
                                        const_cast<std::uint8_t*>(raw.gray.data()))));
  write_text(yaml,
             "fx: 300\nfy: 305\ncx: 155.5\ncy: 124.25\ndistortion_model: plumb_bob\n"
             "dist_coeffs: [0, 0.0, 0., 0, 0]\n");
  const LoadedFrame frame = load_frame_files("", path, load_camera_file(yaml));
  EXPECT_EQ(frame.intensity, raw.gray);
  EXPECT_TRUE(frame.notes.empty());
}

// A polynomial of the image's middle may fold its corners inwards.
TEST(Undistortion, CoefficientsThatDoNotHoldUpToTheCornersAreRefused) {
  EXPECT_FALSE(fold_radius_px({-0.3, 0.1, 0, 0}, kCamera).has_value());
  // Of r (1 - r^2 / 0.75) the largest value is at r = 0.5: 150 px.
  const auto fold_px = fold_radius_px({-1 / 0.75, 0, 0, 0}, kCamera);
  ASSERT_TRUE(fold_px.has_value());
  EXPECT_NEAR(*fold_px, 150, 4);
  EXPECT_TRUE(fold_radius_px({0, 0, 0, 0, 0, -8}, kCamera).has_value()) << "a pole";

  const TemporaryFolder folder;
  const std::string path = folder.file("gray.png");
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(240, 320, CV_8UC1, cv::Scalar(1))));
  FrameCamera camera;
  camera.intrinsics = kCamera;
  camera.lens.k1 = -1 / 0.75;
  EXPECT_THAT(error_of([&] { load_frame_files("", path, camera); }),
              AllOf(HasSubstr(path), HasSubstr("turns back"), HasSubstr("calibrate")));
}

}  // namespace
}  // namespace binpick::drivers
