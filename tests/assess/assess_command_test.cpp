// binpick assess over frames of one scene with fresh noise in each: what it prints, writes,
// refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "binpick/drivers/loaded_frame.hpp"
#include "cli/commands.hpp"
#include "core/bracket.hpp"
#include "sensor/frame_writer.hpp"
#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr double kNoise_mm = 0.3;
constexpr int kFrames = 10;

std::vector<Pose> scene_poses() {
  std::vector<Pose> poses = three_brackets();
  poses.push_back(bracket_pose(20, 300, 60, {70, 45, 505}));
  return poses;
}

// What a sensor with noise of its own in each exposure makes of the scene.
void add_frame(FrameWriter& writer, const BracketScene& clean, unsigned seed) {
  BracketScene scene = clean;
  std::mt19937 random(seed);
  std::normal_distribution<float> depth(0, static_cast<float>(kNoise_mm)), gray(0, 2);
  for (float& z : scene.depth_mm) z += depth(random);
  for (std::uint8_t& v : scene.gray)
    v = static_cast<std::uint8_t>(std::clamp(static_cast<float>(v) + gray(random), 0.0f, 255.0f));
  writer.write(scene.frame());
}

class AssessCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TemporaryFolder;
    const std::vector<std::uint8_t>& bytes = bracket_model_bytes();
    std::ofstream(shared_->file("bracket.bpm"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    record("still", kFrames, Pose{});
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  // Frames 2, 5, 8, ... show the scene moved, twice as far the later ones.
  static void record(const std::string& name, int frames, const Pose& motion) {
    FrameWriter writer(shared_->file(name), 0.05);
    const std::vector<Pose> poses = scene_poses();
    std::vector<Pose> moved;
    for (const Pose& pose : poses) moved.push_back(motion * pose);
    const BracketScene scene = render_brackets(bracket_camera(), poses);
    const BracketScene after = render_brackets(bracket_camera(), moved);
    for (int i = 0; i < frames; ++i)
      add_frame(writer, i % 3 == 2 ? after : scene, static_cast<unsigned>(100 + i));
    writer.finish();
  }

  static std::string path(const std::string& name) { return shared_->file(name); }
  static std::string text_of(const std::string& name) {
    std::ifstream file(path(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }

  // What the command prints; throws as main() gets it.
  static std::string run(const std::string& source, std::vector<std::string> options = {}) {
    CLI::App app;
    int status = -1;
    add_assess_command(app, status);
    std::vector<std::string> words{"assess", source,           "--model",   path("bracket.bpm"),
                                   "--json", path("out.json"), "--threads", "2"};
    words.insert(words.end(), options.begin(), options.end());
    std::ranges::reverse(words);
    ::testing::internal::CaptureStdout();
    try {
      app.parse(words);
    } catch (...) {
      ::testing::internal::GetCapturedStdout();
      throw;
    }
    EXPECT_EQ(status, 0);
    return ::testing::internal::GetCapturedStdout();
  }
  static json answer() { return json::parse(text_of("out.json")); }

  static inline TemporaryFolder* shared_ = nullptr;
};

TEST_F(AssessCommand, MeasuresAStillScene) {
  const std::string text = run(path("still"), {"--report", path("report")});
  EXPECT_THAT(text, HasSubstr("Suggested threshold"));
  EXPECT_THAT(text, HasSubstr("too few to promise"));
  const json out = answer();
  EXPECT_EQ(out["frames"], kFrames);
  EXPECT_TRUE(out["notes"].empty()) << out["notes"];
  EXPECT_NEAR(out["depth_noise_mm"].get<double>(), kNoise_mm, 0.06);
  const json& model = out["models"].at(0);
  EXPECT_EQ(model["model"], "bracket");
  const std::vector<Pose> truth = scene_poses();
  for (const Pose& pose : truth) {
    const Vec3 centre = pose * bracket_model().centre_mm();
    const bool found = std::ranges::any_of(model["parts"], [&](const json& part) {
      const std::vector<double> at = part["centre_mm"];
      return (Vec3(at[0], at[1], at[2]) - centre).norm() < 1.5 && part["found"] == kFrames;
    });
    EXPECT_TRUE(found) << centre.transpose();
  }
  // Exact depth with noise that differs from frame to frame: poses scatter, by far less than it.
  const json& spread = model["repeatability"];
  EXPECT_GE(spread["parts"], truth.size());
  for (const auto& [direction, sigma] : spread["median"].items()) {
    EXPECT_GT(sigma, 0.0) << direction;
    EXPECT_LT(sigma, direction.ends_with("mm") ? kNoise_mm : 1.0) << direction;
  }
  for (const auto& [direction, ratio] : spread["claimed_over_measured"].items())
    EXPECT_GT(ratio, 0.3) << direction;
  int poses = 0;
  for (const int n : model["score_histogram"]["all"]) poses += n;
  EXPECT_GE(poses, kFrames * static_cast<int>(truth.size()));
  const std::string page = text_of("report/assess.html");
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page, HasSubstr("<td>#4</td>"));
}

TEST_F(AssessCommand, TakesTheMotionOfAMovedSceneOut) {
  const Pose motion = left_increment(Pose{}, {0, 0, 9 * kDegree}, {6, -8, 3}, {0, 0, 500});
  record("moved", 12, motion);
  run(path("moved"));
  EXPECT_THAT(answer()["notes"].dump(), HasSubstr("give --moved"));
  const std::string text = run(path("moved"), {"--moved"});
  EXPECT_THAT(text, HasSubstr("Motion of the scene"));
  const json out = answer();
  EXPECT_TRUE(out["notes"].empty()) << out["notes"];
  EXPECT_TRUE(out["refused"].empty()) << out["refused"];
  ASSERT_EQ(out["motions"].size(), 11u);
  int far = 0;
  for (const json& m : out["motions"]) {
    EXPECT_GE(m["poses_that_agree"], 3);
    far += m["rotation_deg"] > 5;
    if (m["rotation_deg"] > 5)
      EXPECT_NEAR(m["rotation_deg"].get<double>(), 9, 0.5);
    else
      EXPECT_LT(m["shift_mm"], 0.5);
  }
  EXPECT_TRUE(far == 4 || far == 8) << "by which frame is the reference: " << far;
  const json& model = out["models"].at(0);
  int always = 0;
  for (const json& part : model["parts"]) always += part["found"] == 12;
  EXPECT_GE(always, 3);
  EXPECT_LT(model["repeatability"]["median"]["x_mm"], kNoise_mm);
}

TEST_F(AssessCommand, RefusesFewFramesAndSaysWhenTheyAreNotMany) {
  EXPECT_THROW(
      try {
        run(path("still"), {"--count", "4"});
      } catch (const SetupError& e) {
        EXPECT_THAT(e.what(), HasSubstr("4 frames to look at"));
        throw;
      },
      SetupError);
  run("replay:" + path("still"), {"--count", "5"});
  EXPECT_THAT(answer()["notes"].dump(), HasSubstr("only 5 frames"));
  EXPECT_THROW(run(path("nowhere")), drivers::DatasetError);
}

}  // namespace
}  // namespace binpick::app
