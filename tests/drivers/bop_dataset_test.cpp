#include "binpick/drivers/bop_dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "binpick/drivers/bop_truth.hpp"
#include "temporary_folder.hpp"

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace binpick::drivers {
namespace {

constexpr const char* kK = "[600, 0, 3.5, 0, 610, 2.5, 0, 0, 1]";

void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

void write_image(const fs::path& path, const cv::Mat& image) {
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(cv::imwrite(path.string(), image)) << path;
}

cv::Mat depth_ramp(int width, int height) {
  cv::Mat depth(height, width, CV_16UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(100 * y + x);
  }
  return depth;
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const DatasetError& e) {
    return e.what();
  }
  return "no error";
}

// A data set of one scene (2) with one gray frame (7), 8x6 pixels, in a folder of its own.
class BopFolder : public testing::Test {
 protected:
  void SetUp() override {
    write_text(camera_path(), std::string(R"({"7": {"cam_K": )") + kK +
                                  R"(, "depth_scale": 0.1, "roi": [1, 2, 4, 3]}})");
    write_image(depth_path(), depth_ramp(8, 6));
    write_image(gray_path(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(77)));
  }

  fs::path scene_folder() const { return root_ / "test/000002"; }
  fs::path camera_path() const { return scene_folder() / "scene_camera.json"; }
  fs::path depth_path() const { return scene_folder() / "depth/000007.png"; }
  fs::path gray_path() const { return scene_folder() / "gray/000007.png"; }
  fs::path models_path() const { return root_ / "models/models_info.json"; }
  BopDataset dataset() const { return BopDataset(root_.string(), "test"); }

  LoadedFrame load() const {
    const BopDataset set = dataset();
    return set.load_frame(set.scene(2), 7);
  }
  // What loading says after the camera file was replaced.
  std::string camera_error(const std::string& json) const {
    write_text(camera_path(), json);
    return error_of([this] { load(); });
  }
  std::string models_error(const std::string& json) const {
    write_text(models_path(), json);
    return error_of([this] { dataset().models(); });
  }
  std::string truth_error() const {
    return error_of([this] { load_truth(dataset(), 2); });
  }

  TemporaryFolder folder_;
  fs::path root_ = folder_.path();
};

TEST_F(BopFolder, ListsScenesAndFramesWithTheirCameras) {
  fs::create_directories(root_ / "test/000011");
  fs::create_directories(root_ / "test/notes");
  EXPECT_THAT(dataset().scene_ids(), ElementsAre(2, 11));
  const BopScene scene = dataset().scene(2);
  ASSERT_EQ(scene.frames.size(), 1u);
  const FrameCamera& camera = scene.frames.at(7);
  EXPECT_DOUBLE_EQ(camera.intrinsics.fy, 610);
  EXPECT_DOUBLE_EQ(camera.depth_scale.value(), 0.1);
  EXPECT_EQ(camera.roi.height, 3);
  EXPECT_EQ(frame_name({2, 7}), "000002/000007");
}

TEST_F(BopFolder, GivesDepthInMillimetresAndGray) {
  const LoadedFrame frame = load();
  const Frame view = frame.view();
  ASSERT_EQ(view.depth_mm.width, 8);
  ASSERT_EQ(view.depth_mm.height, 6);
  EXPECT_FLOAT_EQ(view.depth_mm.at(3, 2), 20.3f);
  EXPECT_EQ(view.intensity.at(7, 5), 77);
  EXPECT_EQ(view.camera.width, 8);
  EXPECT_DOUBLE_EQ(view.camera.cx, 3.5);
  EXPECT_EQ(view.roi.x, 1);
  EXPECT_EQ(view.roi.width, 4);
}

TEST_F(BopFolder, ConvertsColourToGray) {
  fs::remove_all(scene_folder() / "gray");
  cv::Mat colour(6, 8, CV_8UC3, cv::Scalar(0, 0, 200));  // pure red
  write_image(scene_folder() / "rgb/000007.png", colour);
  EXPECT_NEAR(load().intensity[0], 0.299 * 200, 1.0);
}

TEST_F(BopFolder, ReadsTiffDepthAndJpegColour) {
  fs::remove_all(scene_folder() / "gray");
  fs::remove(depth_path());
  write_image(scene_folder() / "depth/000007.tif", depth_ramp(8, 6));
  write_image(scene_folder() / "rgb/000007.jpg", cv::Mat(6, 8, CV_8UC3, cv::Scalar(90, 90, 90)));
  const LoadedFrame frame = load();
  EXPECT_FLOAT_EQ(frame.depth_mm[8 + 1], 10.1f);
  EXPECT_NEAR(frame.intensity[0], 90, 2);
}

TEST_F(BopFolder, AcceptsASensorWithoutIntensity) {
  fs::remove_all(scene_folder() / "gray");
  EXPECT_TRUE(load().view().intensity.empty());
}

TEST_F(BopFolder, NamesAMissingFile) {
  fs::remove(gray_path());
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("gray/000007"));
  fs::remove(depth_path());
  write_image(gray_path(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(1)));
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("depth/000007"));
  fs::remove(camera_path());
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("scene_camera.json"));
}

TEST_F(BopFolder, NamesAMissingFolderSceneOrImage) {
  EXPECT_THAT(error_of([] { BopDataset("/nowhere/at/all", "test"); }),
              HasSubstr("/nowhere/at/all"));
  EXPECT_THAT(error_of([this] { BopDataset(root_.string(), "val"); }), HasSubstr("val"));
  EXPECT_THAT(error_of([this] { dataset().scene(3); }), HasSubstr("no scene 3"));
  EXPECT_THAT(error_of([this] { dataset().load_frame(dataset().scene(2), 8); }),
              AllOf(HasSubstr("scene_camera.json"), HasSubstr("image 8")));
  fs::create_directories(root_ / "empty");
  EXPECT_THAT(error_of([this] { BopDataset(root_.string(), "empty"); }), HasSubstr("no scene"));
}

TEST_F(BopFolder, NamesFileEntryAndKeyOfABadCamera) {
  const auto entry = [](const std::string& k, const std::string& rest) {
    return R"({"7": {"cam_K": )" + k + rest + "}}";
  };
  const auto place = [](const char* key) {
    return AllOf(HasSubstr("scene_camera.json: 7"), HasSubstr(key));
  };
  EXPECT_THAT(camera_error("{"),
              AllOf(HasSubstr("scene_camera.json"), HasSubstr("not valid JSON")));
  EXPECT_THAT(camera_error("[1, 2]"), HasSubstr("not an object"));
  EXPECT_THAT(camera_error(R"({"seven": {}})"), HasSubstr("seven"));
  EXPECT_THAT(camera_error(R"({"7": {"depth_scale": 1}})"), place("fx"));
  EXPECT_THAT(camera_error(entry(kK, "")), place("depth_scale"));
  EXPECT_THAT(camera_error(entry("[1, 2, 3]", R"(, "depth_scale": 1)")),
              place("cam_K: has 3 numbers"));
  EXPECT_THAT(camera_error(entry(R"("wide")", R"(, "depth_scale": 1)")),
              place("cam_K: is not a list"));
  EXPECT_THAT(camera_error(entry("[0, 0, 3, 0, 600, 2, 0, 0, 1]", R"(, "depth_scale": 1)")),
              place("focal"));
  EXPECT_THAT(camera_error(entry("[600, 1, 3, 0, 600, 2, 0, 0, 1]", R"(, "depth_scale": 1)")),
              place("skew"));
  EXPECT_THAT(camera_error(entry(kK, R"(, "depth_scale": "0.1")")),
              place("depth_scale: is not a number"));
  EXPECT_THAT(camera_error(entry(kK, R"(, "depth_scale": 0)")),
              place("depth_scale: is not positive"));
  EXPECT_THAT(camera_error(entry(kK, R"(, "depth_scale": 1, "roi": [0, 0, 5])")), place("roi"));
  EXPECT_THAT(camera_error(entry(kK, R"(, "depth_scale": 1, "roi": [0, 0, 0, 5])")), place("roi"));
  EXPECT_THAT(camera_error(entry(kK, R"(, "depth_scale": 1, "roi": [0.5, 0, 4, 5])")),
              place("whole number"));
}

TEST_F(BopFolder, RefusesImagesOfTheWrongKind) {
  write_image(gray_path(), cv::Mat(6, 9, CV_8UC1, cv::Scalar(1)));
  EXPECT_THAT(error_of([this] { load(); }),
              AllOf(HasSubstr("gray"), HasSubstr("9x6"), HasSubstr("8x6")));
  fs::remove(gray_path());
  const fs::path gray_tiff = scene_folder() / "gray/000007.tif";
  write_image(gray_tiff, cv::Mat(6, 8, CV_32FC1, cv::Scalar(1)));
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("8 or 16 bits"));
  write_image(gray_tiff, cv::Mat(6, 8, CV_8UC1, cv::Scalar(1)));
  write_image(depth_path(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(1)));
  EXPECT_THAT(error_of([this] { load(); }), AllOf(HasSubstr("depth"), HasSubstr("1 of 8")));
  write_image(depth_path(), cv::Mat(6, 8, CV_16UC3, cv::Scalar(1, 1, 1)));
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("3 of 16"));
  write_text(depth_path(), "this is no picture");
  EXPECT_THAT(error_of([this] { load(); }), AllOf(HasSubstr("depth"), HasSubstr("decoded")));
}

TEST_F(BopFolder, RefusesATruncatedImage) {
  fs::resize_file(depth_path(), fs::file_size(depth_path()) / 2);
  EXPECT_THAT(error_of([this] { load(); }), HasSubstr("depth/000007.png"));
}

TEST_F(BopFolder, ReadsModelsWithTheirSymmetries) {
  write_text(models_path(), R"({
    "3": {"diameter": 50.5,
          "symmetries_discrete": [[-1, 0, 0, 0, 0, -1, 0, 4, 0, 0, 1, 0, 0, 0, 0, 1]],
          "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [1, 2, 3]}]},
    "12": {"diameter": 7}})");
  const std::map<int, BopModel> models = dataset().models();
  ASSERT_EQ(models.size(), 2u);
  const BopModel& m = models.at(3);
  EXPECT_DOUBLE_EQ(m.diameter_mm, 50.5);
  EXPECT_EQ(m.mesh_path, (root_ / "models/obj_000003.ply").string());
  ASSERT_EQ(m.symmetries_discrete.size(), 1u);
  EXPECT_TRUE((m.symmetries_discrete[0] * Vec3(1, 2, 3)).isApprox(Vec3(-1, 2, 3)));
  ASSERT_EQ(m.symmetries_continuous.size(), 1u);
  EXPECT_TRUE(m.symmetries_continuous[0].axis.isApprox(Vec3::UnitZ()));
  EXPECT_TRUE(m.symmetries_continuous[0].offset_mm.isApprox(Vec3(1, 2, 3)));
}

TEST_F(BopFolder, NamesWhatIsWrongWithAModelEntry) {
  EXPECT_THAT(error_of([this] { dataset().models(); }), HasSubstr("models_info.json"));
  EXPECT_THAT(models_error(R"({"1": {}})"),
              AllOf(HasSubstr("models_info.json: 1"), HasSubstr("diameter")));
  EXPECT_THAT(models_error(R"({"1": {"diameter": -2}})"), HasSubstr("not positive"));
  EXPECT_THAT(models_error(R"({"1": {"diameter": 2, "symmetries_discrete": [[1, 0]]}})"),
              HasSubstr("symmetries_discrete[0]"));
  EXPECT_THAT(models_error(R"({"1": {"diameter": 2, "symmetries_discrete":
                           [[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]]}})"),
              HasSubstr("not a rotation"));
  EXPECT_THAT(
      models_error(R"({"1": {"diameter": 2, "symmetries_continuous": [{"axis": [0, 0, 0]}]}})"),
      HasSubstr("axis"));
}

TEST_F(BopFolder, ReadsTruthApartFromFrames) {
  EXPECT_TRUE(load_truth(dataset(), 2).empty()) << "no scene_gt.json, no truth, no error";
  write_text(
      scene_folder() / "scene_gt.json",
      R"({"7": [{"obj_id": 3, "cam_R_m2c": [0,-1,0,1,0,0,0,0,1], "cam_t_m2c": [1, 2, 700]}]})");
  auto truth = load_truth(dataset(), 2);
  ASSERT_EQ(truth.at(7).size(), 1u);
  EXPECT_EQ(truth.at(7)[0].obj_id, 3);
  EXPECT_TRUE((truth.at(7)[0].T_cam_obj * Vec3(1, 0, 0)).isApprox(Vec3(1, 3, 700)));
  EXPECT_EQ(truth.at(7)[0].visible_fraction, 1.0);

  write_text(scene_folder() / "scene_gt_info.json", R"({"7": [{"visib_fract": 0.25}]})");
  EXPECT_EQ(load_truth(dataset(), 2).at(7)[0].visible_fraction, 0.25);
}

TEST_F(BopFolder, NamesWhatIsWrongWithTruth) {
  const fs::path gt = scene_folder() / "scene_gt.json",
                 info = scene_folder() / "scene_gt_info.json";
  write_text(gt, R"({"7": [{"obj_id": 3, "cam_R_m2c": [1, 0], "cam_t_m2c": [1, 2, 700]}]})");
  EXPECT_THAT(truth_error(), AllOf(HasSubstr("scene_gt.json: 7[0]"), HasSubstr("cam_R_m2c")));
  write_text(
      gt, R"({"7": [{"obj_id": 3, "cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [1, null, 7]}]})");
  EXPECT_THAT(truth_error(), HasSubstr("cam_t_m2c[1]"));
  write_text(gt,
             R"({"7": [{"obj_id": 3, "cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [1, 2, 7]}]})");
  write_text(info, R"({"7": []})");
  EXPECT_THAT(truth_error(), AllOf(HasSubstr("scene_gt_info.json"), HasSubstr("image 7")));
}

TEST_F(BopFolder, ReadsTargetsWhereThereAreAny) {
  EXPECT_FALSE(load_targets(dataset()).has_value());
  write_text(root_ / "test_targets_bop19.json",
             R"([{"im_id": 7, "inst_count": 2, "obj_id": 3, "scene_id": 2},
                 {"im_id": 7, "inst_count": 1, "obj_id": 5, "scene_id": 2}])");
  const auto targets = load_targets(dataset());
  ASSERT_TRUE(targets.has_value());
  EXPECT_THAT(targets->at({2, 7}), ElementsAre(3, 5));
}

TEST_F(BopFolder, ReadsSingleFilesWithEitherKindOfCamera) {
  const std::string path = (root_ / "camera.json").string();
  write_text(path,
             R"({"fx": 600, "fy": 610, "cx": 3.5, "cy": 2.5, "depth_scale": 0.5,
                    "width": 8, "height": 6})");
  const LoadedFrame frame =
      load_frame_files(depth_path().string(), gray_path().string(), load_camera_file(path));
  EXPECT_FLOAT_EQ(frame.depth_mm[1], 0.5f);
  EXPECT_TRUE(frame.roi.whole_image());

  write_text(path,
             std::string(R"({"cam_K": )") + kK + R"(, "depth_scale": 1, "roi": [1, 1, 3, 3]})");
  EXPECT_EQ(load_frame_files(depth_path().string(), "", load_camera_file(path)).roi.width, 3);

  write_text(
      path,
      R"({"fx": 600, "fy": 610, "cx": 3.5, "cy": 2.5, "depth_scale": 1, "width": 9, "height": 6})");
  EXPECT_THAT(
      error_of([&] { load_frame_files(depth_path().string(), "", load_camera_file(path)); }),
      AllOf(HasSubstr("8x6"), HasSubstr("9x6")));

  write_text(path, R"({"fx": 600, "fy": 610, "cx": 3.5, "cy": 2.5})");
  EXPECT_THAT(
      error_of([&] { load_frame_files(depth_path().string(), "", load_camera_file(path)); }),
      HasSubstr("depth_scale"));
  write_text(path, R"({"fx": 0, "fy": 610, "cx": 3.5, "cy": 2.5})");
  EXPECT_THAT(error_of([&] { load_camera_file(path); }),
              AllOf(HasSubstr("camera.json"), HasSubstr("fx")));
}

}  // namespace
}  // namespace binpick::drivers
