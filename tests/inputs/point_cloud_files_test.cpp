// Organized point clouds, as Photoneo, Zivid, Ensenso, PCL and ROS write them: one table of styles,
// all of the same scene; and what makes a cloud none of a camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "inputs/cloud_files.hpp"
#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using enum CloudEncoding;

struct ReadableCloud {
  const char* what;
  const char* name;
  CloudStyle style;
  double units_per_mm = 1;
  float missing = 0;
};

const std::vector<std::string> kObjInfo = {"obj_info num_cols 48", "obj_info num_rows 36"};

const ReadableCloud kReadableClouds[] = {
    {"PLY of PCL, mm", "cloud.ply", {kBinary, kObjInfo, "", 1, true}, 1, NAN},
    {"PLY, ASCII, zeros where nothing is", "cloud.ply", {kAscii, kObjInfo, "", 1, true}, 1, 0},
    {"PLY, ASCII, NaN where nothing is", "cloud.ply", {kAscii, kObjInfo, "", 1, true}, 1, NAN},
    {"PLY, big-endian, metres", "cloud.ply", {kBigEndian, kObjInfo, "", 1, true}, 1e-3, NAN},
    {"PLY, the grid in a comment",
     "cloud.ply",
     {kBinary, {"comment Width: 48, Height: 36"}, "", 1, true},
     1,
     NAN},
    {"PLY with a comment on something else",
     "cloud.ply",
     {kBinary, {kObjInfo[0], kObjInfo[1], "comment texture width: 99, height: 9"}, "", 1, true}},
    {"PLY with bytes of gray", "cloud.ply", {kBinary, kObjInfo, "uchar intensity", 1, true}},
    {"PLY with gray of 12 bits", "cloud.ply", {kBinary, kObjInfo, "ushort gray", 16, true}},
    {"PLY with gray up to 1", "cloud.ply", {kAscii, kObjInfo, "float Texture", 1 / 255.0, true}},
    {"PLY with gray of CloudCompare",
     "cloud.ply",
     {kBinary, kObjInfo, "float scalar_Intensity", 1, true}},
    {"PLY with colour", "cloud.ply", {kBinary, kObjInfo, "rgb", 1, true}},
    {"PCD, ASCII", "cloud.pcd", {kAscii, {}, "", 1, true}, 1, NAN},
    {"PCD of ROS, metres", "cloud.pcd", {kBinary, {}, "", 1, true}, 1e-3, NAN},
    {"PCD, compressed", "cloud.pcd", {kCompressed, {}, "", 1, true}, 1e-3, NAN},
    {"PCD with intensity", "cloud.pcd", {kBinary, {}, "float intensity", 1, true}, 1e-3, NAN},
    {"PCD, compressed, with intensity of 16 bits",
     "cloud.pcd",
     {kCompressed, {}, "float intensity", 256, true},
     1,
     NAN},
    {"PCD with colour in the bits of a float", "cloud.pcd", {kBinary, {}, "rgb", 1, true}, 1e-3, 0},
};

void write_cloud(const std::string& path, const CloudScene& scene, const CloudStyle& style) {
  if (path.ends_with(".pcd"))
    write_pcd(path, scene, style);
  else
    write_ply(path, scene, style);
}

void expect_scene(const LoadedFrame& frame, const CloudScene& scene) {
  ASSERT_EQ(frame.camera.width, scene.camera.width);
  ASSERT_EQ(frame.camera.height, scene.camera.height);
  for (int i = 0; i < scene.count(); ++i)
    ASSERT_NEAR(frame.depth_mm[static_cast<std::size_t>(i)], scene.depth_mm(i), 1e-3) << i;
}

TEST(PointCloudFiles, OfEveryStyleAreTheSameFrame) {
  const TemporaryFolder folder;
  for (const ReadableCloud& c : kReadableClouds) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    CloudScene scene;
    scene.units_per_mm = c.units_per_mm;
    scene.missing = c.missing;
    write_cloud(path, scene, c.style);
    LoadedFrame frame;
    ASSERT_EQ(error_of([&] { frame = load_frame_files(path, "", {}); }), "no error");
    expect_scene(frame, scene);
    EXPECT_NEAR(frame.camera.fx, scene.camera.fx, 0.01);
    EXPECT_NEAR(frame.camera.fy, scene.camera.fy, 0.01);
    EXPECT_NEAR(frame.camera.cx, scene.camera.cx, 0.01);
    EXPECT_NEAR(frame.camera.cy, scene.camera.cy, 0.01);
    EXPECT_THAT(frame.notes, Contains(HasSubstr("the camera was fitted")));
    EXPECT_THAT(frame.notes,
                Contains(HasSubstr(c.units_per_mm == 1 ? "taken for mm" : "taken for metres")));
    ASSERT_EQ(frame.intensity.empty(), c.style.gray.empty());
    for (std::size_t i = 0; i < frame.intensity.size(); ++i) {
      // Gray up to 1 is stretched to the whole range only where it uses that.
      EXPECT_NEAR(frame.intensity[i], scene.gray(static_cast<int>(i)), 1) << i;
    }
  }
}

TEST(PointCloudFiles, ARangeGridTellsWhereThePointsAre) {
  const TemporaryFolder folder;
  const CloudScene scene;
  write_range_grid_ply(folder.file("cloud.ply"), scene);
  expect_scene(load_frame_files(folder.file("cloud.ply"), "", {}), scene);
}

TEST(PointCloudFiles, TheIntensityImageOrTheCameraTellsTheGrid) {
  const TemporaryFolder folder;
  const CloudScene scene;
  const std::string ply = folder.file("cloud.ply"), pcd = folder.file("cloud.pcd"),
                    gray = folder.file("gray.png");
  write_ply(ply, scene, {kBinary, {}, "uchar intensity", 1, true});
  write_pcd(pcd, scene, {kBinary, {}, "", 1, false});
  ASSERT_TRUE(cv::imwrite(gray, cv::Mat(36, 48, CV_8UC1, cv::Scalar(9))));
  for (const std::string& path : {ply, pcd}) {
    SCOPED_TRACE(path);
    EXPECT_THAT(error_of([&] { load_frame_files(path, "", {}); }),
                AllOf(HasSubstr(path), HasSubstr("1728 points without a grid"),
                      HasSubstr("unorganized"), HasSubstr("Export it organized")));
    const LoadedFrame frame = load_frame_files(path, gray, {});
    expect_scene(frame, scene);
    EXPECT_EQ(frame.intensity[5], 9) << "the image that was given, not the cloud's own";
    FrameCamera camera;
    camera.intrinsics = scene.camera;
    expect_scene(load_frame_files(path, "", camera), scene);
  }
  ASSERT_TRUE(cv::imwrite(gray, cv::Mat(30, 48, CV_8UC1, cv::Scalar(9))));
  write_ply(ply, scene, {kBinary, kObjInfo, "", 1, true});
  EXPECT_THAT(error_of([&] { load_frame_files(ply, gray, {}); }),
              AllOf(HasSubstr("48x30"), HasSubstr("48x36")));
}

// The unit of a camera file's depth images says nothing of a cloud.
TEST(PointCloudFiles, TheUnitIsTheCloudsOwnOrAskedFor) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cloud.ply");
  CloudScene scene;
  write_ply(path, scene, {kBinary, kObjInfo, "", 1, true});
  FrameCamera camera;
  camera.intrinsics = scene.camera;
  camera.depth_scale = 0.1;
  expect_scene(load_frame_files(path, "", camera), scene);
  EXPECT_NEAR(load_frame_files(path, "", camera, 2).depth_mm[0], 2 * scene.depth_mm(0), 1e-3);
}

// A lens bends the rays: the points go where a pinhole camera sees them, with their gray.
TEST(PointCloudFiles, PointsOfABentGridAreProjected) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cloud.ply");
  CloudScene scene;
  scene.lens.k1 = -1.2;
  write_ply(path, scene, {kBinary, kObjInfo, "uchar intensity", 1, true});
  FrameCamera camera;
  camera.intrinsics = scene.camera;
  const LoadedFrame frame = load_frame_files(path, "", camera);
  EXPECT_THAT(frame.notes, Contains(HasSubstr("projected")));
  int found = 0;
  for (int i = 0; i < scene.count(); ++i) {
    if (!scene.measured(i)) continue;
    const auto [x, y, z] = scene.point(i);
    const Vec2 p = scene.camera.project({x, y, z});
    const long u = std::lround(p.x()), v = std::lround(p.y());
    if (u < 0 || v < 0 || u >= scene.camera.width || v >= scene.camera.height) continue;
    const auto at = static_cast<std::size_t>(v * scene.camera.width + u);
    EXPECT_LE(frame.depth_mm[at], z + 1e-3f) << i;
    if (std::abs(frame.depth_mm[at] - z) < 1e-3f && frame.intensity[at] == scene.gray(i)) ++found;
  }
  EXPECT_GT(found, scene.count() / 2);
}

struct RefusedCloud {
  const char* what;
  const char* name;
  std::string text;
  std::vector<std::string> words;
};

std::string ply_of(const std::string& rest) {
  return "ply\nformat ascii 1.0\n" + rest;
}

TEST(PointCloudFiles, RefusedOnesSayWhatIsWrong) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string pcd = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const RefusedCloud kRefusedClouds[] = {
      {"a header without end", "cloud.ply", ply_of("element vertex 2\n" + xyz), {"no end_header"}},
      {"points that are missing",
       "cloud.ply",
       ply_of("element vertex 2\n" + xyz + "end_header\n1 2 3\n4 5\n"),
       {"ends before all"}},
      {"a word among the numbers",
       "cloud.ply",
       ply_of("element vertex 2\n" + xyz + "end_header\n1 2 3\n4 five 6\n"),
       {"no number"}},
      {"an unknown type",
       "cloud.ply",
       ply_of("element vertex 1\nproperty quad x\nend_header\n1\n"),
       {"unknown type 'quad'"}},
      {"no points at all", "cloud.ply", ply_of("end_header\n"), {"without points"}},
      {"a part",
       "part.ply",
       ply_of("element vertex 3\n" + xyz +
              "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
              "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
       {"is a mesh", "binpick train"}},
      {"a grid that does not fit",
       "cloud.ply",
       ply_of("obj_info num_cols 5\nobj_info num_rows 4\nelement vertex 2\n" + xyz +
              "end_header\n1 2 3\n4 5 6\n"),
       {"2 points", "5x4"}},
      {"fields that do not match",
       "cloud.pcd",
       "VERSION .7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n",
       {"FIELDS, SIZE, TYPE and COUNT"}},
      {"rows that are missing",
       "cloud.pcd",
       pcd + "WIDTH 2\nHEIGHT 2\nDATA ascii\n1 2 3\n",
       {"point 1 of 4"}},
      {"bytes that are missing",
       "cloud.pcd",
       pcd + "WIDTH 2\nHEIGHT 2\nDATA binary\n" + std::string(24, '\0'),
       {"2 points", "tells 4"}},
      {"compressed data that are none",
       "cloud.pcd",
       pcd + "WIDTH 2\nHEIGHT 2\nDATA binary_compressed\n" +
           std::string("\x04\0\0\0\x30\0\0\0\xff\xff\xff\xff", 12),
       {"cannot be unpacked"}},
      {"an unknown encoding", "cloud.pcd", pcd + "WIDTH 2\nHEIGHT 2\nDATA zipped\n", {"'zipped'"}},
  };
  const TemporaryFolder folder;
  for (const RefusedCloud& c : kRefusedClouds) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    write_text(path, c.text);
    const std::string error = error_of([&] { load_frame_files(path, "", {}); });
    EXPECT_THAT(error, HasSubstr(path));
    for (const std::string& word : c.words) EXPECT_THAT(error, HasSubstr(word));
  }
}

// Points of a robot's or a table's coordinates lie on no camera's rays.
TEST(PointCloudFiles, PointsThatNoCameraSeesSoAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cloud.ply");
  CloudScene upside_down;
  upside_down.units_per_mm = -1;
  write_ply(path, upside_down, {kBinary, kObjInfo, "", 1, true});
  EXPECT_THAT(error_of([&] { load_frame_files(path, "", {}); }),
              AllOf(HasSubstr("negative z"), HasSubstr("x right, y down")));

  CloudScene scene;
  write_ply(path, scene, {kBinary, kObjInfo, "", 1, true});
  FrameCamera other;
  other.intrinsics = {48, 36, 300, 300, 23, 18};
  EXPECT_THAT(error_of([&] { load_frame_files(path, "", other); }),
              AllOf(HasSubstr("the camera file's camera"), HasSubstr("another camera's")));

  CloudScene mirrored;  // y up
  mirrored.camera.fy = -91;
  write_ply(path, mirrored, {kBinary, kObjInfo, "", 1, true});
  EXPECT_THAT(error_of([&] { load_frame_files(path, "", {}); }),
              AllOf(HasSubstr("any pinhole camera"), HasSubstr("y down")));
}

}  // namespace
}  // namespace binpick::drivers
