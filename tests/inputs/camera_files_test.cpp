// Camera files of every origin, as they are found on disks: one table of those that are read, all
// of the same camera, and one of those that are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "inputs/camera_samples.hpp"
#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(CameraFiles, OfEveryOriginAreTheSameCamera) {
  const TemporaryFolder folder;
  for (const ReadableCamera& c : kReadableCameras) {
    SCOPED_TRACE(c.origin);
    const std::string path = folder.file(c.name);
    write_text(path, c.text);
    FrameCamera camera;
    ASSERT_EQ(error_of([&] { camera = load_camera_file(path); }), "no error");
    EXPECT_EQ(camera.intrinsics.fx, 812.5);
    EXPECT_EQ(camera.intrinsics.fy, 810.25);
    EXPECT_EQ(camera.intrinsics.cx, 401.5);
    EXPECT_EQ(camera.intrinsics.cy, 299.75);
    // A camera matrix alone does not tell the image's size.
    const bool sized = std::string(c.name) != "camera.yml";
    EXPECT_EQ(camera.intrinsics.width, sized ? 800 : 0);
    EXPECT_EQ(camera.intrinsics.height, sized ? 600 : 0);
    EXPECT_EQ(camera.lens.k1, c.k1);
    EXPECT_EQ(camera.lens.none(), c.k1 == 0);
    EXPECT_EQ(camera.depth_scale.value_or(0), c.depth_scale);
    EXPECT_THAT(camera.notes, IsEmpty());
  }
}

TEST(CameraFiles, CoefficientsAreInOpenCvsOrder) {
  const TemporaryFolder folder;
  const std::string path = folder.file("camera.yaml");
  write_text(path, "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\nD: [1, 2, 3, 4, 5, 6, 7, 8]\n");
  const LensDistortion lens = load_camera_file(path).lens;
  EXPECT_THAT(std::vector({lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, lens.k4, lens.k5, lens.k6}),
              ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
}

// What OpenCV itself writes today, in its three syntaxes.
TEST(CameraFiles, OpenCvsOwnFilesAreRead) {
  const TemporaryFolder folder;
  for (const char* name : {"camera.yml", "camera.json", "camera.xml"}) {
    SCOPED_TRACE(name);
    const std::string path = folder.file(name);
    cv::FileStorage storage(path, cv::FileStorage::WRITE);
    storage << "image_width" << 800 << "image_height" << 600;
    storage << "camera_matrix"
            << cv::Mat((cv::Mat_<double>(3, 3) << 812.5, 0, 401.5, 0, 810.25, 299.75, 0, 0, 1));
    storage << "distortion_coefficients"
            << cv::Mat((cv::Mat_<double>(1, 5) << -0.25, 0.125, 1e-4, 0, 0));
    storage.release();
    const FrameCamera camera = load_camera_file(path);
    EXPECT_EQ(camera.intrinsics.cy, 299.75);
    EXPECT_EQ(camera.intrinsics.height, 600);
    EXPECT_EQ(camera.lens.p1, 1e-4);
  }
}

struct RefusedCamera {
  const char* what;
  const char* name;
  const char* text;
  std::vector<std::string> words;  // of the error, besides the file's name
};

const RefusedCamera kRefusedCameras[] = {
    {"a mistyped key",
     "camera.json",
     R"({"fxx": 800, "fy": 800, "cx": 400, "cy": 300})",
     {"no key \"fx\"", "was \"fxx\" meant"}},
    {"nothing of a camera",
     "camera.json",
     R"({"width": 800})",
     {"no camera", "fx", "camera_matrix"}},
    {"a list", "camera.json", "[1, 2, 3]", {"not an object"}},
    {"nothing", "camera.json", "", {"empty"}},
    {"JSON that ends early", "camera.json", R"({"fx": 800, )", {"not valid JSON", "line 1"}},
    {"YAML with a fault", "camera.yaml", "fx: 800\nfy: [1, 2\ncx: 3\n", {"line", "not valid YAML"}},
    {"skew", "camera.json", R"({"K": [800, 0.5, 400, 0, 800, 300, 0, 0, 1]})", {"K", "skew"}},
    {"a transposed matrix",
     "camera.json",
     R"({"K": [800, 0, 0, 0, 800, 0, 400, 300, 1]})",
     {"K", "transposed", "row by row"}},
    {"a matrix that is none of a camera",
     "camera.json",
     R"({"K": [1, 2, 3, 4, 5, 6, 7, 8, 9]})",
     {"K", "pinhole"}},
    {"a matrix of 3 x 4",
     "camera.json",
     R"({"K": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]})",
     {"K", "has 12 numbers where 9 are expected"}},
    {"a negative focal length",
     "camera.json",
     R"({"fx": -800, "fy": 800, "cx": 400, "cy": 300})",
     {"not positive"}},
    {"a number that is none",
     "camera.yaml",
     "fx: .nan\nfy: 800\ncx: 400\ncy: 300\n",
     {"fx", "not finite"}},
    {"a text for a number",
     "camera.yaml",
     "fx: \"800\"\nfy: 800\ncx: 400\ncy: 300\n",
     {"fx", "not a number"}},
    {"two cameras that differ",
     "camera.json",
     R"({"fx": 801, "fy": 800, "cx": 400, "cy": 300, "K": [800, 0, 400, 0, 800, 300, 0, 0, 1]})",
     {"not the same camera"}},
    {"RealSense's inverse model",
     "color.json",
     R"({"fx": 800, "fy": 800, "ppx": 400, "ppy": 300, "model": "distortion.inverse_brown_conrady",
         "coeffs": [0.1, 0, 0, 0, 0]})",
     {"inverse Brown-Conrady", "rectify"}},
    {"RealSense's inverse model, by its number",
     "color.json",
     R"({"fx": 800, "fy": 800, "ppx": 400, "ppy": 300, "model": 2, "coeffs": [0.1, 0, 0, 0, 0]})",
     {"inverse Brown-Conrady"}},
    {"a fisheye, even of zeros",
     "fisheye.yaml",
     "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\ndistortion_model: equidistant\nD: [0, 0, 0, 0]\n",
     {"equidistant", "rectify"}},
    {"a model that nobody knows",
     "camera.yaml",
     "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\ndistortion_model: wavy\nD: [1, 0, 0, 0]\n",
     {"'wavy'"}},
    {"a number of coefficients that no model has",
     "camera.json",
     R"({"K": [800, 0, 400, 0, 800, 300, 0, 0, 1], "D": [1, 2, 3]})",
     {"3 coefficients", "4"}},
    {"a tilted sensor",
     "camera.json",
     R"({"K": [800, 0, 400, 0, 800, 300, 0, 0, 1], "D": [0,0,0,0,0,0,0,0,0,0,0,0,0.1,0]})",
     {"tilted"}},
    {"ROS' region of interest",
     "camera.yaml",
     "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\nroi: {x_offset: 8, y_offset: 0, width: 9, height: "
     "9}\n",
     {"x_offset", "as it is"}},
    {"binning",
     "camera.yaml",
     "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\nbinning_x: 2\n",
     {"binning_x", "after binning"}},
    {"several cameras",
     "rig.json",
     R"({"color": {"fx": 800, "fy": 800, "cx": 400, "cy": 300},
         "depth": {"fx": 600, "fy": 600, "cx": 320, "cy": 240}})",
     {"several cameras: color, depth", "rig.json#color"}},
    {"an image given for it",
     "camera.json",
     "\x89PNG\r\n\x1a\n",
     {"PNG image", "not a camera file"}},
    {"a ROS bag given for it", "camera.yaml", "#ROSBAG V2.0\n", {"ROS bag", "not a camera file"}},
};

TEST(CameraFiles, RefusedOnesSayWhatIsWrong) {
  const TemporaryFolder folder;
  for (const RefusedCamera& c : kRefusedCameras) {
    SCOPED_TRACE(c.what);
    const std::string path = folder.file(c.name);
    write_text(path, c.text);
    const std::string error = error_of([&] { load_camera_file(path); });
    EXPECT_THAT(error, HasSubstr(path));
    for (const std::string& word : c.words) EXPECT_THAT(error, HasSubstr(word));
  }
}

TEST(CameraFiles, OneOfSeveralCamerasIsChosenByName) {
  const TemporaryFolder folder;
  const std::string path = folder.file("rig#2.json");  // a name with the mark in it
  write_text(path, R"({"left": {"color": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "depth":
                        {"fx": 2, "fy": 2, "cx": 2, "cy": 2}},
                       "right": {"color": {"fx": 3, "fy": 3, "cx": 3, "cy": 3}}})");
  EXPECT_EQ(load_camera_file(path + "#left.color").intrinsics.fx, 1);
  EXPECT_EQ(load_camera_file(path + "#depth").intrinsics.fx, 2);
  EXPECT_THAT(error_of([&] { load_camera_file(path + "#color"); }), HasSubstr("more than one"));
  EXPECT_THAT(error_of([&] { load_camera_file(path + "#infrared"); }),
              AllOf(HasSubstr("'infrared' names none"), HasSubstr("left.color")));
}

// The images of a sensor are used as they come.
TEST(CameraFiles, OfALiveSensorHaveNoDistortion) {
  const TemporaryFolder folder;
  const std::string path = folder.file("camera.yaml");
  write_text(path, "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\nD: [-0.1, 0, 0, 0]\n");
  EXPECT_THAT(error_of([&] { load_sensor_camera_file(path); }),
              AllOf(HasSubstr(path), HasSubstr("lens distortion"), HasSubstr("rectif")));
  write_text(path, "K: [800, 0, 400, 0, 800, 300, 0, 0, 1]\nD: [0, 0, 0, 0]\n");
  EXPECT_EQ(load_sensor_camera_file(path).intrinsics.fx, 800);
}

TEST(CameraFiles, UnknownKeysAreNamedWithTheOneThatWasMeant) {
  const TemporaryFolder folder;
  const std::string path = folder.file("camera.json");
  const auto notes = [&](const std::string& more) {
    write_text(path, R"({"fx": 8, "fy": 8, "cx": 4, "cy": 3, )" + more + "}");
    return load_camera_file(path).notes;
  };
  EXPECT_THAT(notes(R"("depth_scal": 0.1)"),
              ElementsAre(AllOf(HasSubstr("warning: " + path), HasSubstr("\"depth_scal\""),
                                HasSubstr("was \"depth_scale\" meant"))));
  EXPECT_THAT(notes(R"("distortion_coefs": [0, 0, 0, 0])"),
              ElementsAre(HasSubstr("was \"distortion_coeffs\" meant")));
  EXPECT_THAT(notes(R"("wdith": 8)"), ElementsAre(HasSubstr("was \"width\" meant")));
  EXPECT_THAT(notes(R"("operator": "Ada")"), ElementsAre(testing::Not(HasSubstr("meant"))));
  EXPECT_THAT(notes(R"("x": 1)"), ElementsAre(testing::Not(HasSubstr("meant"))));
  EXPECT_THAT(notes(R"("frame_id": "camera", "rectification_matrix": [1], "serial_number": 7)"),
              IsEmpty());
}

}  // namespace
}  // namespace binpick::drivers
