#include "eval/reliability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/reliability_tables.hpp"
#include "eval/svg_chart.hpp"

using testing::HasSubstr;

namespace binpick::app {
namespace {

std::vector<JudgedPose> poses(double probability, int count, int right) {
  std::vector<JudgedPose> out;
  for (int i = 0; i < count; ++i) out.push_back({probability, i < right});
  return out;
}

const ReliabilityBin& bin_of(const Reliability& r, double probability) {
  for (const ReliabilityBin& bin : r.bins) {
    if (probability >= bin.from && probability < bin.to) return bin;
  }
  return r.bins.back();
}

TEST(RightShare, HasWilsonsInterval) {
  // Worked by hand: 8 of 10, z = 1.96.
  const RightShare seen{10, 8};
  EXPECT_DOUBLE_EQ(seen.share(), 0.8);
  EXPECT_NEAR(seen.low(), 0.4902, 1e-4);
  EXPECT_NEAR(seen.high(), 0.9433, 1e-4);
}

TEST(RightShare, StaysInsideZeroAndOneAndSaysNothingOfNothing) {
  EXPECT_NEAR((RightShare{20, 20}.low()), 0.8389, 1e-4);
  EXPECT_DOUBLE_EQ((RightShare{20, 20}.high()), 1);
  EXPECT_NEAR((RightShare{20, 0}.low()), 0, 1e-12);
  EXPECT_DOUBLE_EQ((RightShare{}.low()), 0);
  EXPECT_DOUBLE_EQ((RightShare{}.high()), 1);
}

TEST(Reliability, MeansAndSharesOfEachBin) {
  std::vector<JudgedPose> all = poses(0.62, 10, 6);
  for (const JudgedPose& p : poses(0.68, 10, 8)) all.push_back(p);
  for (const JudgedPose& p : poses(0.96, 20, 19)) all.push_back(p);
  const Reliability r = reliability_of(all, 0.85);
  EXPECT_EQ(r.count, 40);
  EXPECT_EQ(bin_of(r, 0.65).seen.count, 20);
  EXPECT_NEAR(bin_of(r, 0.65).probability, 0.65, 1e-12);
  EXPECT_DOUBLE_EQ(bin_of(r, 0.65).seen.share(), 0.7);
  EXPECT_DOUBLE_EQ(bin_of(r, 0.96).seen.share(), 0.95);
  EXPECT_EQ(bin_of(r, 0.1).seen.count, 0);
  EXPECT_NEAR(r.calibration_error, 0.5 * 0.05 + 0.5 * 0.01, 1e-12);
  EXPECT_EQ(r.accepted.count, 20);
  EXPECT_EQ(r.accepted.right, 19);
}

TEST(Reliability, EveryProbabilityHasOneBin) {
  std::vector<JudgedPose> all;
  for (int i = 0; i <= 100; ++i) all.push_back({i / 100.0, true});
  const Reliability r = reliability_of(all, 1.0);
  int sum = 0;
  for (const ReliabilityBin& bin : r.bins) sum += bin.seen.count;
  EXPECT_EQ(sum, 101);
  EXPECT_EQ(bin_of(r, 0.0).seen.count, 10);
  EXPECT_EQ(bin_of(r, 1.0).seen.count, 3) << "0.98, 0.99 and 1";
  EXPECT_EQ(r.accepted.count, 1) << "the threshold is accepted";
}

TEST(Reliability, PoseOfAPartThatNeedNotBeFoundIsRight) {
  PartScore part;
  part.obj_id = 3;
  part.marks = {{0, Verdict::kRight, 0}, {1, Verdict::kNeutral, 1}, {2, Verdict::kWrong, -1}};
  std::vector<ResultRow> rows(3);
  rows[0].score = 0.9, rows[1].score = 0.91, rows[2].score = 0.92;
  ScoreReport report;
  report.parts = {part};
  report.mixed = {part};
  report.mixed[0].mixed_scene = 7;
  const std::vector<Reliability> r = find_reliability(report, rows, 0.85);
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[0].name, "obj 3");
  EXPECT_EQ(r[1].name, "scene 7, obj 3");
  EXPECT_EQ(r[2].name, "all");
  EXPECT_EQ(r[0].accepted.right, 2);
  EXPECT_EQ(r[2].accepted.count, 6);
  EXPECT_EQ(r[2].accepted.right, 4);
}

TEST(Reliability, OfNothingIsNothing) {
  ScoreReport report;
  report.parts = {PartScore{}};
  EXPECT_TRUE(find_reliability(report, {}, 0.85).empty());
  EXPECT_EQ(reliability_table({}), "");
  EXPECT_EQ(reliability_section_html({}), "");
  EXPECT_EQ(reliability_of({}, 0.85).calibration_error, 0);
}

TEST(Reliability, IsShownAsTextPageAndJson) {
  Reliability r = reliability_of(poses(0.96, 20, 19), 0.85);
  r.name = "obj <1>";
  const std::string text = reliability_table({r});
  EXPECT_THAT(text, HasSubstr("poses at 0.85"));
  EXPECT_THAT(text, HasSubstr("0.764 .. 0.991"));
  EXPECT_THAT(text, HasSubstr("0.95 .. 0.98"));
  const std::string page = reliability_section_html({r});
  EXPECT_THAT(page, HasSubstr("obj &lt;1&gt;"));
  EXPECT_THAT(page, HasSubstr("19 of 20 right"));
  EXPECT_THAT(reliability_svg(r), HasSubstr("class='diagonal'"));
  const nlohmann::json json = reliability_to_json({r});
  EXPECT_EQ(json[0]["accepted"]["right"], 19);
  EXPECT_EQ(json[0]["accepted"]["threshold"], 0.85);
  EXPECT_EQ(json[0]["bins"].size(), r.bins.size());
  EXPECT_TRUE(json[0]["bins"][0]["share"].is_null());
}

}  // namespace
}  // namespace binpick::app
