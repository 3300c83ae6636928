// What surrounds the detector in an evaluation: plan, distance range, model cache, tables and
// report.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "cli/id_list.hpp"
#include "eval/distance_range.hpp"
#include "eval/eval_plan.hpp"
#include "eval/html_text.hpp"
#include "eval/model_cache.hpp"
#include "eval/reliability_tables.hpp"
#include "eval/report_html.hpp"
#include "eval/svg_chart.hpp"
#include "eval/table.hpp"
#include "eval/worst_frames.hpp"
#include "temporary_folder.hpp"

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace binpick::app {
namespace {

Pose pose_at(double x_mm) {
  return {Mat3::Identity(), Vec3(x_mm, 0, 700)};
}

PartScore scored_part(int obj_id) {
  PartScore p;
  p.obj_id = obj_id;
  p.frames = {{1, 0}, {1, 1}};
  p.instances = 4;
  p.detections = 3;
  p.best = {0.857, 0.75, 1.0, 0.62};
  p.curve = {{0.9, 0.25, 1.0}, {0.62, 0.75, 1.0}, {0.3, 0.75, 0.6}};
  p.mean_abs_error = PoseError6{0.11, 0.22, 0.33, 0.44, 0.55, 0.66};
  p.time = {2, 0.0904, 0.09, 0.12, 0.1234};
  return p;
}

RunLine run_line() {
  RunSummary s;
  s.frames = 2;
  s.time = {2, 0.0315, 0.03, 0.04, 0.05};
  s.level_count = 2;
  for (int i = 0; i < kStageCount; ++i) s.stage_ms[i] = i + 1;
  s.level_ms = {3.25, 4.5};
  s.candidates = {812, 97};
  s.templates_evaluated = {123456, 7890};
  s.dropped[2] = 17;
  return {"obj 1", s};
}

ReportContent content() {
  ReportContent c;
  c.title = "binpick on <bolts & nuts>";
  c.facts = {{"threads", "2"}};
  c.score.parts = {scored_part(1), scored_part(2)};
  c.score.mean = mean_of(c.score.parts);
  c.lines = {run_line()};
  c.models = {{1, {500, 760}, false, 12.5, 3000000}};
  c.reliability = reliability_section_html({reliability_of({{0.9, true}, {0.3, false}}, 0.85)});
  c.reach = "<h2>What is reachable</h2>";
  c.causes = "<h2>Every fault and its cause</h2>";
  c.fault_pictures = {{"missed, search: scan", {4, 5, 6}}};
  c.pictures = {{"scene 1, image 0, obj 1: 2 right, 1 false pick, 1 missed", {1, 2, 3}}};
  return c;
}

std::size_t count(const std::string& text, const std::string& piece) {
  std::size_t n = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1))
    ++n;
  return n;
}

TEST(ReportPage, CarriesEverythingItself) {
  const std::string page = report_html(content());
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,AQID"));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
}

TEST(ReportPage, ShowsScoresCurvesLevelsAndPictures) {
  const std::string page = report_html(content());
  EXPECT_EQ(count(page, "<svg class='chart'"), 3u);
  EXPECT_THAT(page, HasSubstr("<h2>Reliability of the score"));
  EXPECT_THAT(page, HasSubstr("<td class='main'>0.857</td>"));
  EXPECT_THAT(page, HasSubstr("<td>31.5</td>"));
  EXPECT_THAT(page, HasSubstr("123456"));
  EXPECT_THAT(page, HasSubstr("<td>812</td>"));
  EXPECT_THAT(page, HasSubstr("1 false pick, 1 missed"));
  EXPECT_THAT(page, HasSubstr("missed, search: scan"));
  EXPECT_THAT(page, HasSubstr("<h2>What is reachable"));
  EXPECT_THAT(page, HasSubstr("<h2>Every fault"));
  EXPECT_THAT(page, HasSubstr("500 – 760"));
  EXPECT_THAT(page, Not(HasSubstr("<h2>Faults")));
}

TEST(ReportPage, EscapesWhatComesFromOutside) {
  ReportContent c = content();
  c.faults = {"frame <script>alert(1)</script>"};
  const std::string page = report_html(c);
  EXPECT_THAT(page, HasSubstr("&lt;bolts &amp; nuts&gt;"));
  EXPECT_THAT(page, HasSubstr("<h2>Faults"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

TEST(ReportPage, ClosesEveryElementItOpens) {
  const std::string page = report_html(content());
  for (const char* name :
       {"table", "tr", "td", "th", "div", "svg", "figure", "span", "h2", "main", "text", "i"}) {
    const std::string n = name;
    EXPECT_EQ(count(page, "<" + n + ">") + count(page, "<" + n + " "), count(page, "</" + n + ">"))
        << n;
  }
}

TEST(ReportPage, IsMadeOfNothingToo) {
  EXPECT_THAT(report_html({}), HasSubstr("</html>"));
}

TEST(Base64, MatchesTheStandardsExamples) {
  const auto encode = [](const std::string& s) {
    return base64({reinterpret_cast<const std::uint8_t*>(s.data()), s.size()});
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(ConsoleTable, HasALinePerPartAndTheMean) {
  ScoreReport report;
  report.options.fixed_threshold = 0.5;
  report.parts = {scored_part(1), scored_part(2)};
  report.mixed = {scored_part(3)};
  report.mixed[0].mixed_scene = 7;
  report.mean = mean_of(report.parts);
  const std::string table = score_table(report);
  EXPECT_EQ(count(table, "\n"), 2u + 4u);
  EXPECT_THAT(table, HasSubstr("F1@0.50"));
  EXPECT_THAT(table, HasSubstr("scene 7, obj 3"));
  EXPECT_THAT(table, HasSubstr("0.11 0.22 0.33"));
  EXPECT_THAT(table, HasSubstr("123.4"));
  EXPECT_THAT(stage_table({run_line()}), HasSubstr("36.0")) << "the sum of 1 to 8";
  EXPECT_THAT(level_table({run_line()}), HasSubstr("17.0"));
}

TEST(RunSummary, AveragesTheFramesOfAPart) {
  EvalRun run;
  run.frames[{1, 0}].report.candidates = {10, 20};
  run.frames[{1, 1}].report.candidates = {30, 40};
  run.frames[{1, 1}].report.level_count = 2;
  run.frames[{2, 0}].report.candidates = {1000, 1000};
  const RunSummary s = summarize_runs(run, {{1, 0}, {1, 1}, {1, 2}});
  EXPECT_EQ(s.frames, 2);
  EXPECT_EQ(s.level_count, 2);
  EXPECT_EQ(s.candidates[0], 20);
  EXPECT_EQ(s.candidates[1], 30);
}

TEST(WorstFrames, ListMissesAndFalsePicksAboveTheThreshold) {
  PartScore part = scored_part(1);
  part.best.threshold = 0.5;
  TruthByFrame truth;
  truth[{1, 0}] = {
      {{1, pose_at(0), 1}, true}, {{1, pose_at(100), 1}, true}, {{1, pose_at(200), 0.2}, true}};
  truth[{1, 1}] = {{{1, pose_at(0), 1}, true}};
  const std::vector<ResultRow> rows{
      {{1, 0}, 1, 0.9, pose_at(0), 0},
      {{1, 0}, 1, 0.8, pose_at(50), 0},
      {{1, 0}, 1, 0.2, pose_at(100), 0},  // right, but below the threshold
      {{1, 1}, 1, 0.9, pose_at(0), 0}};
  part.marks = {{0, Verdict::kRight, 0},
                {1, Verdict::kWrong, -1},
                {2, Verdict::kRight, 1},
                {3, Verdict::kRight, 0}};
  ScoreReport report;
  report.parts = {part};
  const std::vector<FrameOutcome> worst = worst_frames(report, truth, rows, 5);
  ASSERT_EQ(worst.size(), 1u) << "the second frame has no fault";
  EXPECT_EQ(caption(worst[0]), "scene 1, image 0, obj 1: 1 right, 1 false pick, 1 missed");
  EXPECT_THAT(worst[0].missed_instances, ElementsAre(1));

  const train::Mesh mesh;
  const std::vector<OverlayItem> items = overlay_items(worst[0], truth, rows, mesh);
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[0].style, OverlayStyle::kFalsePick);
  EXPECT_EQ(items[1].style, OverlayStyle::kMiss);
  EXPECT_EQ(items[2].style, OverlayStyle::kRight);
}

TEST(DistanceRanges, AreRobustAgainstStrayDepth) {
  std::vector<float> depth(200 * 100);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = 600.f + static_cast<float>(i % 100);
  for (std::size_t i = 0; i < depth.size(); i += 401) depth[i] = 3.f;
  for (std::size_t i = 7; i < depth.size(); i += 401) depth[i] = 9000.f;
  depth[50] = std::numeric_limits<float>::quiet_NaN();
  Frame frame;
  frame.depth_mm = {depth.data(), 200, 100, 200};
  frame.camera = {200, 100, 1e6, 1e6, 100, 50};
  const auto range = measured_range(frame);
  ASSERT_TRUE(range.has_value());
  EXPECT_NEAR(range->min_mm, 600, 3);
  EXPECT_NEAR(range->max_mm, 699, 3);
}

TEST(DistanceRanges, LookInsideTheRoiOnlyAndAlongTheRay) {
  std::vector<float> depth(200 * 100, 5000.f);
  for (int y = 20; y < 80; ++y) {
    for (int x = 0; x < 60; ++x) depth[static_cast<std::size_t>(200 * y + x)] = 1000.f;
  }
  Frame frame;
  frame.depth_mm = {depth.data(), 200, 100, 200};
  frame.camera = {200, 100, 100, 100, 100, 50};
  frame.roi = {-5, 20, 65, 60};  // reaches beyond the image
  const auto range = measured_range(frame);
  ASSERT_TRUE(range.has_value());
  EXPECT_LT(range->max_mm, 1000 * std::sqrt(1 + 1 + 0.09) + 1);
  EXPECT_GT(range->max_mm, 1350) << "column 0 is seen at 45 degrees";
}

TEST(DistanceRanges, NeedMeasurements) {
  const std::vector<float> depth(200 * 100, 0.f);
  Frame frame;
  frame.depth_mm = {depth.data(), 200, 100, 200};
  frame.camera = {200, 100, 100, 100, 100, 50};
  EXPECT_FALSE(measured_range(frame).has_value());
  EXPECT_FALSE(training_range({}, 50, frame.camera).has_value());
}

TEST(DistanceRanges, CoverAllFramesAndHalfThePartBeyond) {
  const CameraIntrinsics camera{1280, 1024, 1900, 1900, 640, 512};
  const auto range = training_range({{603, 700}, {650, 742}}, 50, camera);
  EXPECT_EQ(range->min_mm, 570);
  EXPECT_EQ(range->max_mm, 770);
}

TEST(DistanceRanges, EndWhereThePartCannotBeRecognised) {
  const CameraIntrinsics camera{640, 480, 600, 600, 320, 240};
  const auto range = training_range({{20, 8000}}, 100, camera);
  EXPECT_EQ(range->min_mm, 100) << "the camera stays outside the part";
  EXPECT_EQ(range->max_mm, 1500) << "40 pixels";
  const CameraIntrinsics tele{640, 480, 6000, 6000, 320, 240};
  EXPECT_EQ(training_range({{20, 8000}}, 100, tele)->min_mm, 930) << "640 pixels";
}

TEST(TrainingKey, ChangesWithEveryOptionAndTheMesh) {
  const train::TrainOptions base;
  std::set<std::uint64_t> keys{training_key(1, base, {}), training_key(2, base, {})};
  std::size_t changes = 2;
  const auto expect_new = [&](auto member, auto value) {
    train::TrainOptions options = base;
    options.*member = value;
    keys.insert(training_key(1, options, {}));
    EXPECT_EQ(keys.size(), ++changes);
  };
  using T = train::TrainOptions;
  expect_new(&T::camera, CameraIntrinsics{640, 480, 600, 600, 320, 240});
  expect_new(&T::camera, CameraIntrinsics{640, 480, 600, 600, 320, 240.5});
  expect_new(&T::distance_min_mm, 501.0);
  expect_new(&T::distance_max_mm, 701.0);
  expect_new(&T::tilt_max_deg, 90.0);
  expect_new(&T::samples, 999);
  expect_new(&T::gradient_threshold, 0.15);
  expect_new(&T::normal_threshold, 0.25);
  expect_new(&T::tilt_jitter_deg, 9.0);
  expect_new(&T::roll_jitter_deg, 7.0);
  expect_new(&T::distance_jitter_mm, 80.0);
  expect_new(&T::roll_interval_deg, 5.0);
  expect_new(&T::distance_interval_mm, 60.0);
  expect_new(&T::tree_depths, 3);
  expect_new(&T::normal_codebook, NormalCodebook::kAzimuth);
  expect_new(&T::contour_features, 55);
  expect_new(&T::surface_features, 41);
  expect_new(&T::seed, std::uint64_t{2});
  keys.insert(training_key(1, base, {.calibration_piles = 5}));
  keys.insert(training_key(1, base, {.test_piles = 1}));
  EXPECT_EQ(keys.size(), changes + 2);
  EXPECT_EQ(training_key(1, base, {}), training_key(1, train::TrainOptions{}, {}));
}

TEST(ModelCache, KeepsModelsByObjectAndKey) {
  const TemporaryFolder folder;
  const ModelCache cache(folder.file("made/here"));
  EXPECT_FALSE(cache.find(1, 42).has_value());
  cache.keep(1, 42, {1, 2, 3});
  EXPECT_THAT(cache.find(1, 42).value(), ElementsAre(1, 2, 3));
  EXPECT_FALSE(cache.find(2, 42).has_value());
  EXPECT_FALSE(cache.find(1, 43).has_value());
  cache.keep(1, 42, {4});
  EXPECT_THAT(cache.find(1, 42).value(), ElementsAre(4));
}

TEST(ModelCache, WithoutAFolderKeepsNothing) {
  const ModelCache cache("");
  cache.keep(1, 42, {1, 2, 3});
  EXPECT_FALSE(cache.find(1, 42).has_value());
}

TEST(IdList, ReadsNumbersAndRanges) {
  EXPECT_THAT(parse_id_list("--scenes", "1,2,5-7"), ElementsAre(1, 2, 5, 6, 7));
  EXPECT_TRUE(parse_id_list("--scenes", "").empty());
  for (const char* bad : {"a", "1,", "1,,2", "3-1", "-4", "1-", "1-2-3", "1.5", "9999999", " 1"}) {
    if (std::string(bad) == "1,") continue;  // a trailing comma does no harm
    EXPECT_ANY_THROW(parse_id_list("--scenes", bad)) << bad;
  }
}

// Two scenes: 1 with objects 1 and 2 and two cameras, 2 whose camera file is broken.
class PlannedFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto entry = [](double f) {
      return "{\"cam_K\": [" + std::to_string(f) + ",0,320,0,600,240,0,0,1], \"depth_scale\": 1}";
    };
    const std::string instance =
        R"({"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,700], "obj_id": )";
    write("test/000001/scene_camera.json",
          "{\"0\": " + entry(600) + ", \"1\": " + entry(600.5) + ", \"2\": " + entry(900) + "}");
    write("test/000001/scene_gt.json", "{\"0\": [" + instance + "1}], \"1\": [" + instance +
                                           "2}], \"2\": [" + instance + "1}]}");
    write("test/000002/scene_camera.json", "{");
  }
  void write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_.file(name);
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  EvalPlan plan(const EvalSelection& selection) const {
    return make_eval_plan(drivers::BopDataset(folder_.path(), "test"), selection);
  }

  TemporaryFolder folder_;
};

TEST_F(PlannedFolder, GroupsFramesByCameraAndNamesBrokenScenes) {
  const EvalPlan p = plan({});
  ASSERT_EQ(p.frames.size(), 3u);
  ASSERT_EQ(p.cameras.size(), 2u) << "600 and 600.5 are one camera, 900 is another";
  EXPECT_THAT(p.cameras[0].frames, ElementsAre(0u, 1u));
  EXPECT_THAT(p.objects(), ElementsAre(1, 2));
  ASSERT_EQ(p.faults.size(), 1u);
  EXPECT_THAT(p.faults[0], HasSubstr("000002/scene_camera.json"));
}

TEST_F(PlannedFolder, LooksOnlyForWhatWasAskedFor) {
  const EvalPlan p = plan({{1}, {2}});
  ASSERT_EQ(p.frames.size(), 1u);
  EXPECT_EQ(p.frames[0].id, (drivers::FrameId{1, 1}));
  EXPECT_TRUE(p.faults.empty());
  EXPECT_THROW(plan({{9}, {}}), drivers::DatasetError);
  EXPECT_THROW(plan({{1}, {9}}), drivers::DatasetError);
}

TEST_F(PlannedFolder, TakesTargetsBeforeTruth) {
  write("test_targets_bop19.json",
        R"([{"scene_id": 1, "im_id": 2, "obj_id": 5, "inst_count": 1}])");
  const EvalPlan p = plan({{1}, {}});
  ASSERT_EQ(p.frames.size(), 1u);
  EXPECT_EQ(p.frames[0].id.im_id, 2);
  EXPECT_THAT(p.frames[0].objects, ElementsAre(5));
  EXPECT_EQ(p.truth.size(), 1u);
}

TEST_F(PlannedFolder, NeedsTruthOrTargets) {
  fs::remove(folder_.file("test/000001/scene_gt.json"));
  const EvalPlan p = plan({{1}, {}});
  EXPECT_TRUE(p.frames.empty());
  ASSERT_EQ(p.faults.size(), 1u);
  EXPECT_THAT(p.faults[0], HasSubstr("neither scene_gt.json nor targets"));
}

}  // namespace
}  // namespace binpick::app
