// Data sets of the BOP layout with several sensors, as ITODD, IPD and XYZ-IBD have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "binpick/drivers/bop_truth.hpp"
#include "eval/eval_plan.hpp"
#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Scene 3 with image 5, seen by a 3D sensor (gray and depth) and a colour camera. Every sensor has
// its own camera, images and truth.
class SensorSet : public testing::Test {
 protected:
  void SetUp() override {
    write("scene_camera_photoneo.json", R"({"5": {"cam_K": [500, 0, 4, 0, 500, 3, 0, 0, 1]}})");
    write("scene_camera_cam1.json",
          R"({"5": {"cam_K": [700, 0, 4, 0, 700, 3, 0, 0, 1], "depth_scale": 0.5}})");
    write("scene_gt_photoneo.json", truth_of(8));
    write("scene_gt_cam1.json", truth_of(9));
    image("depth_photoneo", cv::Mat(6, 8, CV_16UC1, cv::Scalar(1000)));
    image("gray_photoneo", cv::Mat(6, 8, CV_8UC1, cv::Scalar(50)));
    image("depth_cam1", cv::Mat(6, 8, CV_16UC1, cv::Scalar(1000)));
    image("rgb_cam1", cv::Mat(6, 8, CV_8UC3, cv::Scalar(80, 80, 80)));
  }

  static std::string truth_of(int obj_id) {
    return R"({"5": [{"obj_id": )" + std::to_string(obj_id) +
           R"(, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 700]}]})";
  }
  void write(const std::string& name, const std::string& text) const {
    write_text(folder_.file("test/000003/" + name), text);
  }
  void image(const std::string& kind, const cv::Mat& pixels) const {
    const std::string path = folder_.file("test/000003/" + kind + "/000005.png");
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    ASSERT_TRUE(cv::imwrite(path, pixels));
  }
  BopDataset set(const std::string& sensor) const { return {folder_.path(), "test", sensor}; }
  LoadedFrame load(const std::string& sensor) const {
    return set(sensor).load_frame(set(sensor).scene(3), 5);
  }
  app::EvalPlan plan(const std::string& sensor, const std::set<int>& objects = {}) const {
    return app::make_eval_plan(set(sensor), {{}, objects});
  }

  TemporaryFolder folder_;
};

TEST_F(SensorSet, WithoutANameItsSensorsAreListed) {
  EXPECT_THAT(error_of([&] { set(""); }),
              AllOf(HasSubstr("several sensors: cam1, photoneo"), HasSubstr("--sensor")));
  EXPECT_THAT(error_of([&] { set("xyz"); }),
              AllOf(HasSubstr("no sensor 'xyz'"), HasSubstr("cam1, photoneo")));
}

TEST_F(SensorSet, EachSensorHasItsOwnCameraImagesAndTruth) {
  EXPECT_EQ(load("cam1").camera.fx, 700);
  EXPECT_EQ(load("cam1").depth_mm[0], 500);
  EXPECT_EQ(load("cam1").intensity[0], 80);
  EXPECT_EQ(load_truth(set("cam1"), 3).at(5).at(0).obj_id, 9);
  EXPECT_EQ(load_truth(set("photoneo"), 3).at(5).at(0).obj_id, 8);
}

TEST_F(SensorSet, TheDepthScaleOfTheSetServesFramesWithoutOne) {
  EXPECT_THAT(error_of([&] { load("photoneo"); }),
              AllOf(HasSubstr("scene_camera_photoneo.json: 5"), HasSubstr("depth_scale"),
                    HasSubstr("camera.json")));
  write_text(folder_.file("camera.json"),
             R"({"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": 0.25})");
  EXPECT_EQ(load("photoneo").depth_mm[0], 250);
  EXPECT_EQ(load("photoneo").camera.fx, 500) << "and nothing else of it";
  write_text(folder_.file("camera_photoneo.json"), R"({"depth_scale": 0.125})");
  EXPECT_EQ(load("photoneo").depth_mm[0], 125);
  EXPECT_EQ(load("cam1").depth_mm[0], 500) << "which has its own";
  write_text(folder_.file("camera_photoneo.json"), R"({"depth_scale": 0})");
  EXPECT_THAT(error_of([&] { load("photoneo"); }),
              AllOf(HasSubstr("camera_photoneo.json: depth_scale"), HasSubstr("not positive")));
}

// Here the unit belongs to the format: nothing is inferred from the values.
TEST_F(SensorSet, FloatsHaveTheDepthScaleToo) {
  std::filesystem::remove(folder_.file("test/000003/depth_cam1/000005.png"));
  ASSERT_TRUE(cv::imwrite(folder_.file("test/000003/depth_cam1/000005.tif"),
                          cv::Mat(6, 8, CV_32FC1, cv::Scalar(1300.5))));
  EXPECT_EQ(load("cam1").depth_mm[0], 650.25f);
}

TEST_F(SensorSet, ASetWithOneUnnamedSensorTakesNoName) {
  const TemporaryFolder plain;
  write_text(plain.file("test/000001/scene_camera.json"), "{}");
  EXPECT_EQ(BopDataset(plain.path(), "test").scene_file(1, "scene_gt"),
            plain.file("test/000001/scene_gt.json"));
  EXPECT_THAT(error_of([&] { BopDataset(plain.path(), "test", "cam1"); }),
              AllOf(HasSubstr("no sensor 'cam1'"), HasSubstr("leave --sensor out")));
}

// Targets of 2024 name frames only: their objects are those of the truth.
TEST_F(SensorSet, TargetsOf2024ChooseFrames) {
  write("scene_camera_cam1.json",
        R"({"5": {"cam_K": [700, 0, 4, 0, 700, 3, 0, 0, 1], "depth_scale": 0.5},
            "6": {"cam_K": [700, 0, 4, 0, 700, 3, 0, 0, 1], "depth_scale": 0.5}})");
  EXPECT_EQ(plan("cam1").frames.size(), 1u) << "of the two only one has truth";
  write("scene_gt_cam1.json", R"({"5": [], "6": [{"obj_id": 2,
        "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 700]}]})");
  write_text(folder_.file("test_targets_bop24.json"), R"([{"scene_id": 3, "im_id": 6}])");
  const app::EvalPlan chosen = plan("cam1");
  ASSERT_EQ(chosen.frames.size(), 1u);
  EXPECT_EQ(chosen.frames[0].id.im_id, 6);
  EXPECT_THAT(chosen.frames[0].objects, ElementsAre(2));

  write_text(folder_.file("test_targets_bop19.json"),
             R"([{"scene_id": 3, "im_id": 5, "obj_id": 4, "inst_count": 1}])");
  EXPECT_THAT(plan("cam1").frames[0].objects, ElementsAre(4)) << "which has precedence";
}

// Of the sets of 2024 the truth is secret: whoever runs them says what to look for.
TEST_F(SensorSet, WithoutTruthTheObjectsAreThoseAskedFor) {
  std::filesystem::remove(folder_.file("test/000003/scene_gt_cam1.json"));
  EXPECT_THAT(plan("cam1").faults,
              ElementsAre(AllOf(HasSubstr("scene_gt.json"), HasSubstr("--objects"))));
  EXPECT_THAT(plan("cam1", {4, 9}).frames[0].objects, ElementsAre(4, 9));
  write_text(folder_.file("test_targets_bop24.json"), R"([{"scene_id": 3, "im_id": 5}])");
  EXPECT_THAT(plan("cam1", {4}).frames[0].objects, ElementsAre(4));
}

}  // namespace
}  // namespace binpick::drivers
