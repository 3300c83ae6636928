// Frames made worse, and the curves over it.
#include "eval/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "eval/sweep_tables.hpp"

using testing::ElementsAre;
using testing::HasSubstr;

namespace binpick::app {
namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr double kNoise_mm = 0.2;

// A plane tilted about the vertical axis, with noise and a gray ramp.
drivers::LoadedFrame frame() {
  drivers::LoadedFrame f;
  f.camera = {kWidth, kHeight, 800, 800, 99.5, 79.5};
  f.roi = {20, 10, 160, 140};
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, kNoise_mm);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      f.depth_mm.push_back(static_cast<float>(600 + 0.2 * (x - 100) + noise(random)));
      f.intensity.push_back(static_cast<std::uint8_t>(60 + x / 2));
    }
  }
  return f;
}

drivers::LoadedFrame disturbed(Disturbance what, double level, std::uint64_t seed = 1) {
  drivers::LoadedFrame f = frame();
  disturb(f, what, level, seed);
  return f;
}

bool same(const drivers::LoadedFrame& a, const drivers::LoadedFrame& b) {
  return a.depth_mm == b.depth_mm && a.intensity == b.intensity && a.camera.fx == b.camera.fx &&
         a.camera.fy == b.camera.fy && a.camera.cx == b.camera.cx && a.camera.cy == b.camera.cy;
}

TEST(Disturb, LeavesTheFrameAsItIsAtTheFirstLevel) {
  for (int i = 0; i < kDisturbanceCount; ++i) {
    const auto d = static_cast<Disturbance>(i);
    EXPECT_TRUE(same(disturbed(d, sweep_levels(d).front()), frame())) << disturbance_name(d);
  }
}

TEST(Disturb, GivesTheSameFrameForTheSameSeed) {
  for (int i = 0; i < kDisturbanceCount; ++i) {
    const auto d = static_cast<Disturbance>(i);
    const double level = sweep_levels(d).back();
    EXPECT_TRUE(same(disturbed(d, level), disturbed(d, level))) << disturbance_name(d);
    EXPECT_FALSE(same(disturbed(d, level), frame())) << disturbance_name(d);
    const bool by_seed = d != Disturbance::kContrast && d != Disturbance::kFocal;
    EXPECT_EQ(by_seed, !same(disturbed(d, level), disturbed(d, level, 2))) << disturbance_name(d);
  }
}

TEST(Disturb, MeasuresTheNoiseOfAFrame) {
  EXPECT_NEAR(depth_noise_share(frame()) * 600 * 600, kNoise_mm, 0.1 * kNoise_mm);
  drivers::LoadedFrame smooth = frame();
  std::fill(smooth.depth_mm.begin(), smooth.depth_mm.end(), 600.0f);
  smooth.depth_scale_mm = 1;
  EXPECT_NEAR(depth_noise_share(smooth) * 600 * 600, 1 / std::sqrt(12.0), 1e-6)
      << "that of the image's steps";
}

TEST(Disturb, RaisesTheNoiseToItsMultiple) {
  const drivers::LoadedFrame before = frame();
  for (const double level : {2.0, 4.0, 8.0}) {
    const drivers::LoadedFrame after = disturbed(Disturbance::kNoise, level);
    double sum = 0;
    for (std::size_t i = 0; i < before.depth_mm.size(); ++i) {
      const double added = static_cast<double>(after.depth_mm[i] - before.depth_mm[i]);
      sum += added * added;
    }
    const double deviation = std::sqrt(sum / static_cast<double>(before.depth_mm.size()));
    EXPECT_NEAR(std::hypot(deviation, kNoise_mm), level * kNoise_mm, 0.1 * level * kNoise_mm);
  }
}

TEST(Disturb, TakesTheShareOfTheDepthInsideTheRoiAlone) {
  const drivers::LoadedFrame f = disturbed(Disturbance::kMissing, 0.3);
  int inside = 0, outside = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (f.depth_mm[static_cast<std::size_t>(y * kWidth + x)] > 0) continue;
      const bool in = x >= 20 && x < 180 && y >= 10 && y < 150;
      ++(in ? inside : outside);
    }
  }
  EXPECT_EQ(inside, static_cast<int>(0.3 * 160 * 140));
  EXPECT_EQ(outside, 0);
  const drivers::LoadedFrame all = disturbed(Disturbance::kMissing, 1.0);
  EXPECT_EQ(all.depth_mm[static_cast<std::size_t>(80 * kWidth + 100)], 0) << "ends at all of it";
}

TEST(Disturb, FlattensContrastAroundTheMean) {
  const drivers::LoadedFrame f = disturbed(Disturbance::kContrast, 0.25);
  const auto [low, high] = std::minmax_element(f.intensity.begin(), f.intensity.end());
  EXPECT_NEAR(*high - *low, 25, 1);
  EXPECT_NEAR((*high + *low) / 2.0, 109.5, 1);
}

// The plane's left side is nearer: its normal points to the right.
TEST(Disturb, ShadesByTheAngleBetweenLightAndSurface) {
  const std::size_t middle = 80 * kWidth + 100;
  std::vector<int> grays;
  for (std::uint64_t seed = 0; seed < 12; ++seed)
    grays.push_back(disturbed(Disturbance::kLight, 60, seed).intensity[middle]);
  const auto [low, high] = std::minmax_element(grays.begin(), grays.end());
  EXPECT_LT(*high, frame().intensity[middle]) << "a slanting light is weaker";
  EXPECT_GT(*high, *low + 5) << "one from the side that it faces less so";
  drivers::LoadedFrame blind = frame();
  blind.intensity.clear();
  disturb(blind, Disturbance::kLight, 60, 1);
  disturb(blind, Disturbance::kContrast, 0.5, 1);
  EXPECT_TRUE(blind.intensity.empty());
}

TEST(Disturb, ErrsInTheCameraByWhatIsSaid) {
  EXPECT_DOUBLE_EQ(disturbed(Disturbance::kFocal, 2).camera.fx, 816);
  const CameraIntrinsics c = disturbed(Disturbance::kCentre, 8).camera;
  EXPECT_NEAR(std::hypot(c.cx - 99.5, c.cy - 79.5), 8, 1e-9);
}

TEST(SweepList, NamesDisturbances) {
  EXPECT_THAT(parse_disturbances("light,noise,light"),
              ElementsAre(Disturbance::kLight, Disturbance::kNoise));
  EXPECT_EQ(parse_disturbances("all").size(), static_cast<std::size_t>(kDisturbanceCount));
  for (const char* wrong : {"", "noise,", "fog", "noise, light"})
    EXPECT_THROW(parse_disturbances(wrong), std::invalid_argument) << wrong;
}

PartScore part() {
  PartScore p;
  p.obj_id = 1;
  p.frames = {{1, 0}};
  p.instances = 2;
  p.best = {0.8, 1.0, 0.667, 0.4};
  p.fixed = ThresholdScore{0.7, 0.6, 0.9, 0.5};
  p.curve = {{0.9, 0.5, 1.0}, {0.4, 1.0, 0.5}};
  p.marks = {{0, Verdict::kRight, 0}, {1, Verdict::kNeutral, 1}, {2, Verdict::kRight, 2}};
  return p;
}

TEST(SweepCurves, ShowF1OverTheThresholdFromTheRunAlone) {
  ScoreReport score;
  score.parts = {part()};
  const SweepCurves c = threshold_curves(score);
  EXPECT_THAT(c.parts[0].x, ElementsAre(0.4, 0.9));
  EXPECT_NEAR(c.parts[0].y[0], 2.0 / 3, 1e-9);
  EXPECT_NEAR(c.parts[0].y[1], 2.0 / 3, 1e-9);
}

// A part of which nothing is found says nothing about precision, but counts for recall.
TEST(SweepCurves, MeanPrecisionIsOverPartsOfWhichAnythingIsFound) {
  ScoreReport score;
  score.parts = {part(), part()};
  score.parts[0].fixed->judged = 10;
  score.parts[1].fixed = ThresholdScore{0, 0, 0, 0.5, 0};
  const Sweep sweep({Disturbance::kMissing});  // nothing was found at any level beyond the first
  const SweepCurves c = score_sweep(sweep, score, {}, {}).at(0);
  ASSERT_EQ(c.means.size(), 3U);
  EXPECT_DOUBLE_EQ(c.means[0].y.front(), 0.35);
  EXPECT_THAT(c.means[1].x, ElementsAre(0));
  EXPECT_THAT(c.means[1].y, ElementsAre(0.9));
  EXPECT_DOUBLE_EQ(c.means[2].y.front(), 0.3);
}

TEST(SweepCurves, ShowWhatIsFoundByVisibility) {
  ScoreReport score;
  score.parts = {part()};
  const Pose pose;
  const TruthByFrame truth{{{1, 0},
                            {{{1, pose, 0.95}, true},
                             {{1, pose, 0.45}, true},
                             {{1, pose, 1.0}, true},
                             {{1, pose, 0.41}, true},
                             {{2, pose, 0.95}, true},
                             {{1, pose, 0.95}, false}}}};
  const std::vector<ResultRow> rows{{{1, 0}, 1, 0.9, pose, 0},
                                    {{1, 0}, 1, 0.5, pose, 0},
                                    {{1, 0}, 1, 0.3, pose, 0}};  // the last below the threshold
  const SweepCurves c = visibility_curves(score, truth, rows);
  EXPECT_THAT(c.parts[0].x, ElementsAre(0.45, 0.95));
  EXPECT_THAT(c.parts[0].y, ElementsAre(0.5, 0.5));
}

TEST(SweepTables, CarryTheSameNumbersInTextHtmlAndJson) {
  const std::vector<SweepCurves> curves{{"contrast",
                                         "contrast of the intensity image",
                                         "F1",
                                         {{"obj 1", {1, 0.5}, {0.9, 0.8125}}},
                                         {{"recall", {1, 0.5}, {0.9, 0.7}}}}};
  const std::string text = sweep_table(curves, 0.25);
  EXPECT_THAT(text, HasSubstr("F1 over contrast of the intensity image"));
  EXPECT_LT(text.find("0.900"), text.find("0.812")) << "worse to the right";
  EXPECT_THAT(text, HasSubstr("0.25 mm"));
  const std::string html = sweep_section_html(curves, 0.25);
  EXPECT_THAT(html, HasSubstr("obj 1: 0.812"));
  EXPECT_THAT(html, HasSubstr("class='line line-0'"));
  const nlohmann::json out = sweep_to_json(curves, 0.25);
  EXPECT_EQ(out["contrast"]["parts"][0]["y"][1], 0.8125);
  EXPECT_EQ(out["noise"]["x1_mm"], 0.25);
  EXPECT_EQ(sweep_section_html({}, 0), "");
}

}  // namespace
}  // namespace binpick::app
