// Frames as they come on the first day: what is wrong with each, and whether it is refused.
#include "binpick/check/frame_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "core/allocation_count.hpp"
#include "core/bracket.hpp"
#include "core/detector_rig.hpp"
#include "frame_findings.hpp"

namespace binpick::app {
namespace {

using testing::HasSubstr;

// Trained for 460 to 600 mm.
const ObjectModel& model() {
  static const std::vector<std::uint8_t> bytes = tiny_model_bytes();
  static const ObjectModel once = ObjectModel::parse(bytes).value();
  return once;
}

// Brackets at 460 to 540 mm on a plane, in units of 0.1 mm.
struct TestFrame {
  BracketScene scene = good();
  Roi roi;
  bool without_depth = false, without_intensity = false;

  static const BracketScene& good() {
    static const BracketScene once = render_brackets(bracket_camera(), three_brackets(), 0.3);
    return once;
  }
  Frame view() const {
    Frame frame = scene.frame();
    frame.roi = roi;
    frame.depth_scale_mm = 0.1;
    if (without_depth) frame.depth_mm = {};
    if (without_intensity) frame.intensity = {};
    return frame;
  }
  FrameFindings check() const { return check_frame(view(), {{&model(), 1}, {}}); }

  void scale_depth(float factor) {
    for (float& z : scene.depth_mm) z *= factor;
  }
  // In every `nth` column.
  void write_depth(float depth_mm, int nth = 1) {
    for (std::size_t i = 0; i < scene.depth_mm.size(); ++i) {
      if (static_cast<int>(i) % scene.camera.width % nth == 0) scene.depth_mm[i] = depth_mm;
    }
  }
  void shift_intensity(int dx_px, int dy_px) {
    const std::vector<std::uint8_t> gray = scene.gray;
    const int width = scene.camera.width, height = scene.camera.height;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int from_x = (x - dx_px + width) % width, from_y = (y - dy_px + height) % height;
        scene.gray[static_cast<std::size_t>(y * width + x)] =
            gray[static_cast<std::size_t>(from_y * width + from_x)];
      }
    }
  }
};

std::string sentence_of(const Finding& finding) {
  return finding_text(finding, [](int) { return std::string("bracket"); });
}

struct WrongFrame {
  const char* what;
  std::function<void(TestFrame&)> spoil;
  FindingCode code;
  bool refused;
  const char* says;  // a part of the sentence
};

using Code = FindingCode;

const WrongFrame kWrongFrames[] = {
    {"depth_scale 0.001 instead of 0.1", [](TestFrame& f) { f.scale_depth(0.01f); },
     Code::kDepthUnit, true,
     "100 times too small for bracket, which was trained for 460 to 600 mm"},
    {"metres taken for millimetres", [](TestFrame& f) { f.scale_depth(0.001f); }, Code::kDepthUnit,
     true, "set depth_scale to 100 mm per unit of the depth image; it is 0.1"},
    {"depth_scale 1 instead of 0.1", [](TestFrame& f) { f.scale_depth(10); }, Code::kDepthUnit,
     true, "10 times too large"},
    {"depth_scale 0.01 instead of 0.1", [](TestFrame& f) { f.scale_depth(0.1f); }, Code::kDepthUnit,
     true, "10 times too small"},
    {"micrometres taken for millimetres", [](TestFrame& f) { f.scale_depth(1000); },
     Code::kDepthUnit, true, "1000 times too large"},
    {"the sensor moved away", [](TestFrame& f) { f.scale_depth(2.2f); }, Code::kDepthNotTrained,
     false, "not those that bracket was trained for (460 to 600 mm)"},
    {"an empty depth image", [](TestFrame& f) { f.write_depth(0); }, Code::kNothingMeasured, true,
     "no pixel"},
    {"a depth image of NaN", [](TestFrame& f) { f.write_depth(std::nanf("")); },
     Code::kNothingMeasured, true, "no pixel"},
    {"next to no depth",
     [](TestFrame& f) {
       for (std::size_t i = 0; i < f.scene.depth_mm.size(); ++i) {
         if (i % 97 != 0) f.scene.depth_mm[i] = 0;
       }
     },
     Code::kLittleMeasured, false, "% of the region of interest has a depth"},
    {"65535 where nothing was measured", [](TestFrame& f) { f.write_depth(6553.5f, 3); },
     Code::kDepthRepeatedValue, true, "value 65535 in the image"},
    {"the maximum range where nothing was measured", [](TestFrame& f) { f.write_depth(3000, 4); },
     Code::kDepthRepeatedValue, false, "the one depth 3000 mm"},
    {"a depth image of one value", [](TestFrame& f) { f.write_depth(520); },
     Code::kDepthAllOneValue, false, "the same depth, 520 mm"},
    {"a depth image of one value that no part can have", [](TestFrame& f) { f.write_depth(2047); },
     Code::kDepthAllOneValue, true, "the same depth, 2047 mm"},
    {"a region beside the image",
     [](TestFrame& f) {
       f.roi = {600, 20, 100, 100};
     },
     Code::kRoiOutside, true, "lies outside the image of 480x360 pixels"},
    {"a region that barely touches the image",
     [](TestFrame& f) {
       f.roi = {440, 300, 400, 400};
     },
     Code::kRoiBarelyInside, false, "only 1.5 % of the region of interest lies in the image"},
    {"the principal point of a larger image", [](TestFrame& f) { f.scene.camera.cx = 640; },
     Code::kPrincipalPointOff, false, "(640, 178.6) lies outside the image of 480x360"},
    {"a principal point beyond any lens", [](TestFrame& f) { f.scene.camera.cy = -3000; },
     Code::kPrincipalPointOff, true, "lies outside the image"},
    {"the focal length in mm", [](TestFrame& f) { f.scene.camera.fx = f.scene.camera.fy = 16; },
     Code::kFocalLengthImplausible, true, "in pixels of this image, not in mm"},
    {"a focal length of a fisheye",
     [](TestFrame& f) {
       f.scene.camera.fx = 130;
       f.scene.camera.fy = 210;
     },
     Code::kFocalLengthImplausible, false, "angle of view"},
    {"focal lengths that differ", [](TestFrame& f) { f.scene.camera.fy = 1600; },
     Code::kFocalLengthImplausible, false, "fx = 800 and fy = 1600 px"},
    {"the camera file of a much larger image",
     [](TestFrame& f) { f.scene.camera.fx = f.scene.camera.fy = 12800; }, Code::kPartTooLarge, true,
     "bracket would be"},
    {"a black image", [](TestFrame& f) { std::ranges::fill(f.scene.gray, std::uint8_t{9}); },
     Code::kIntensityBlack, false, "is black"},
    {"a black image, and no depth",
     [](TestFrame& f) {
       std::ranges::fill(f.scene.gray, std::uint8_t{9});
       f.without_depth = true;
     },
     Code::kIntensityBlack, true, "is black"},
    {"a white image", [](TestFrame& f) { std::ranges::fill(f.scene.gray, std::uint8_t{255}); },
     Code::kIntensitySaturated, false, "100 % of the intensity image is saturated"},
    {"a gray image", [](TestFrame& f) { std::ranges::fill(f.scene.gray, std::uint8_t{99}); },
     Code::kIntensityFlat, false, "no contrast: it is 99 everywhere"},
    {"intensity of a camera beside the depth sensor",
     [](TestFrame& f) { f.shift_intensity(24, 0); }, Code::kIntensityNotRegistered, false,
     "about 24 px beside them along x"},
    {"intensity of a camera below the depth sensor",
     [](TestFrame& f) { f.shift_intensity(0, -20); }, Code::kIntensityNotRegistered, false,
     "about -20 px beside them along y"},
};

TEST(FrameCheck, NamesWhatIsWrong) {
  for (const WrongFrame& wrong : kWrongFrames) {
    TestFrame frame;
    wrong.spoil(frame);
    const FrameFindings findings = frame.check();
    const auto found = findings.found();
    const auto it = std::ranges::find(found, wrong.code, &Finding::code);
    ASSERT_NE(found.end(), it) << wrong.what;
    EXPECT_EQ(wrong.refused, it->refuses) << wrong.what;
    EXPECT_EQ(wrong.refused, findings.refusal() != nullptr) << wrong.what;
    EXPECT_THAT(sentence_of(*it), HasSubstr(wrong.says)) << wrong.what;
  }
}

TEST(FrameCheck, EveryCodeIsReached) {
  std::set<FindingCode> reached = {Code::kPartTooSmall};  // LowResolution
  for (const WrongFrame& wrong : kWrongFrames) reached.insert(wrong.code);
  EXPECT_EQ(static_cast<std::size_t>(kFindingCodeCount), reached.size());
}

TEST(FrameCheck, FindsNothingInAGoodFrame) {
  TestFrame frame;
  EXPECT_EQ(0, frame.check().count);
  frame.roi = {60, 40, 360, 280};
  EXPECT_EQ(0, frame.check().count);
  frame.without_intensity = true;
  EXPECT_EQ(0, frame.check().count);
  frame.without_intensity = false;
  frame.without_depth = true;
  EXPECT_EQ(0, frame.check().count);
}

TEST(FrameCheck, APlaneOfExactlyOneDepthIsNoMistake) {
  TestFrame frame;
  frame.scene = render_brackets(bracket_camera(), three_brackets(), 0);
  EXPECT_EQ(0, frame.check().count);
}

TEST(FrameCheck, LowResolution) {
  TestFrame frame;
  frame.scene = render_brackets({60, 45, 100, 100, 29.5, 22}, three_brackets(), 0.3);
  const FrameFindings findings = frame.check();
  ASSERT_EQ(1, findings.count);
  EXPECT_EQ(Code::kPartTooSmall, findings.list[0].code);
  EXPECT_THAT(sentence_of(findings.list[0]), HasSubstr("px large in this image"));
}

// What is chosen is judged; the other image may be as it likes.
TEST(FrameCheck, LooksAtTheImagesThatAreSearched) {
  TestFrame frame;
  frame.write_depth(0);
  FrameCheckRequest request{{&model(), 1}, {}, Modality::kIntensity};
  EXPECT_EQ(0, check_frame(frame.view(), request).count);
  frame = {};
  std::ranges::fill(frame.scene.gray, std::uint8_t{0});
  request.modality = Modality::kDepth;
  EXPECT_EQ(0, check_frame(frame.view(), request).count);
}

// As for a capture: no model says what to expect.
TEST(FrameCheck, WithoutAModelOnlyTheImpossibleIsAMistake) {
  TestFrame frame;
  EXPECT_EQ(0, check_frame(frame.view(), {}).count);
  frame.scale_depth(3);
  EXPECT_EQ(0, check_frame(frame.view(), {}).count);
  frame.scale_depth(0.001f);
  const FrameFindings findings = check_frame(frame.view(), {});
  ASSERT_EQ(1, findings.count);
  EXPECT_EQ(Code::kDepthUnit, findings.list[0].code);
  EXPECT_TRUE(findings.list[0].refuses);
}

// A range that spans powers of ten meets any factor by chance.
TEST(FrameCheck, AFactorOfTenIsNoProofForWideDistances) {
  TestFrame frame;
  frame.scale_depth(0.3f);  // 140 to 170 mm: something lies in front of the lens
  const FrameFindings findings = frame.check();
  ASSERT_EQ(1, findings.count);
  EXPECT_EQ(Code::kDepthNotTrained, findings.list[0].code);
  EXPECT_FALSE(findings.list[0].refuses);
}

TEST(FrameCheck, AllocatesNothing) {
  if (!allocations_counted()) GTEST_SKIP() << "the sanitizer holds malloc";
  TestFrame frame;
  frame.shift_intensity(24, 0);
  frame.check();
  const long long before = allocation_count();
  const FrameFindings findings = frame.check();
  std::array<char, 400> memory;
  FixedText text(memory);
  write_finding(findings.list[0], "bracket", text);
  write_advice(findings.list[0], text);
  EXPECT_EQ(before, allocation_count());
  EXPECT_TRUE(text.whole());
}

TEST(FrameCheck, IsWrittenAsJson) {
  TestFrame frame;
  frame.scale_depth(0.01f);
  const auto json = to_json(frame.check(), [](int) { return std::string("bracket"); });
  ASSERT_EQ(1u, json.size());
  EXPECT_EQ("depth_unit", json[0]["code"]);
  EXPECT_EQ("refused", json[0]["severity"]);
  EXPECT_EQ("bracket", json[0]["part"]);
  EXPECT_EQ(100, json[0]["numbers"]["factor"]);
  EXPECT_THAT(json[0]["advice"], HasSubstr("set depth_scale to 10 mm"));
}

// Where nothing is found, the report has what came nearest.
TEST(BestRejected, IsThePoseThatANearlyRightThresholdWouldHaveGiven) {
  DetectorRig rig;
  const TestFrame frame;
  DetectRequest request;
  request.min_score = 1;
  const DetectionReport none = rig.detector.detect(frame.view(), request).value();
  ASSERT_TRUE(none.detections.empty());
  ASSERT_TRUE(none.best_rejected.has_value());
  EXPECT_EQ(DropReason::kBelowMinScore, none.best_rejected->reason);
  request.min_score = none.best_rejected->pose.score;
  const DetectionReport found = rig.detector.detect(frame.view(), request).value();
  ASSERT_EQ(1u, found.detections.size());
  EXPECT_FALSE(found.best_rejected.has_value());
  EXPECT_EQ(none.best_rejected->pose.T_cam_obj.t_mm, found.detections[0].T_cam_obj.t_mm);
}

TEST(BestRejected, NothingWhereNothingResemblesThePart) {
  DetectorRig rig;
  TestFrame frame;
  frame.write_depth(0);
  std::ranges::fill(frame.scene.gray, std::uint8_t{60});
  const DetectionReport report = rig.detector.detect(frame.view(), {}).value();
  EXPECT_TRUE(report.detections.empty());
  EXPECT_FALSE(report.best_rejected.has_value());
}

}  // namespace
}  // namespace binpick::app
