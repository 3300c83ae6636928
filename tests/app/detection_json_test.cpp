#include "detection_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace binpick::app {
namespace {

Detection sample_detection() {
  Detection d;
  d.model_index = 1;
  d.T_cam_obj.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  d.T_cam_obj.t_mm = Vec3(10, 20, 600);
  d.score = 0.75;
  d.template_index = 42;
  return d;
}

TEST(DetectionJson, QuaternionIsUnitWithPositiveW) {
  const double h = std::sqrt(0.5);
  const std::array<double, 4> q = quaternion_wxyz(sample_detection().T_cam_obj.R);
  const std::array<double, 4> expected = {h, 0, 0, h};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(q[i], expected[i], 1e-12);
  for (double angle_rad = -3; angle_rad < 3; angle_rad += 0.5) {
    const Mat3 R = rotation_from_vector(Vec3(0.3, -0.5, 0.8).normalized() * angle_rad);
    const std::array<double, 4> p = quaternion_wxyz(R);
    EXPECT_GE(p[0], 0);
    const Mat3 back = Eigen::Quaterniond(p[0], p[1], p[2], p[3]).toRotationMatrix();
    EXPECT_LT((back - R).norm(), 1e-12);
  }
}

TEST(DetectionJson, WritesPoseByRows) {
  const std::vector<Detection> detections = {sample_detection()};
  const std::vector<std::string> names = {"bolt", "nut"};
  DetectionReport report;
  report.detections = detections;
  const auto json = to_json(report, names);
  const auto& d = json["detections"][0];
  EXPECT_EQ(d["model"], "nut");
  EXPECT_EQ(d["T_cam_obj"].dump(),
            "[[0.0,-1.0,0.0,10.0],[1.0,0.0,0.0,20.0],[0.0,0.0,1.0,600.0],[0.0,0.0,0.0,1.0]]");
  EXPECT_EQ(d["translation_mm"].dump(), "[10.0,20.0,600.0]");
  EXPECT_EQ(d["score"], 0.75);
  EXPECT_EQ(d["template_index"], 42);
}

TEST(DetectionJson, NamesEveryStageLevelAndReason) {
  DetectionReport report;
  report.level_count = 2;
  report.candidates = {100, 7, 0, 0, 0};
  report.templates_evaluated = {5000000000, 800, 0, 0, 0};
  report.stage_ms[static_cast<int>(Stage::kAlign)] = 2.5;
  report.dropped[static_cast<int>(DropReason::kDuplicate)] = 3;
  const auto json = to_json(report, std::vector<std::string>{});
  EXPECT_TRUE(json["detections"].is_array());
  EXPECT_EQ(json["levels"].size(), 2u);
  EXPECT_EQ(json["levels"][0]["templates_evaluated"], 5000000000);
  EXPECT_EQ(json["levels"][1]["candidates"], 7);
  EXPECT_EQ(json["stage_ms"].size(), static_cast<std::size_t>(kStageCount));
  EXPECT_EQ(json["stage_ms"][stage_name(Stage::kAlign)], 2.5);
  EXPECT_EQ(json["dropped"].size(), static_cast<std::size_t>(kDropReasonCount));
  EXPECT_EQ(json["dropped"][drop_reason_name(DropReason::kDuplicate)], 3);
}

}  // namespace
}  // namespace binpick::app
