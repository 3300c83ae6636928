#include "sensor/sensor_profile_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.file("p.toml");
  std::ofstream(path) << text;
  try {
    load_sensor_profile(path);
  } catch (const SetupError& e) {
    const std::string message = e.what();
    EXPECT_TRUE(message.starts_with(path)) << message;
    return message.substr(path.size());
  }
  return "";
}

TEST(SensorProfile, AllThatAreShippedCanBeReadAndAreFoundByTheirSensors) {
  const auto profiles = load_sensor_profiles(BINPICK_SENSOR_PROFILES);
  ASSERT_EQ(profiles.size(), 5u);
  EXPECT_EQ(find_profile(profiles, "Roboception GmbH", "rc_visard 160m-6")->name,
            "roboception-rc-visard");
  EXPECT_EQ(find_profile(profiles, "Basler", "blaze-101")->name, "basler-blaze");
  EXPECT_EQ(find_profile(profiles, "Basler", "acA1300"), nullptr);
  EXPECT_EQ(find_profile(profiles, "", ""), nullptr);
}

TEST(SensorProfile, TheGenericOneIsTheDefault) {
  const auto read = load_sensor_profile(BINPICK_SENSOR_PROFILES "/generic-genicam-3d.toml");
  const drivers::SensorProfile standard;
  EXPECT_EQ(read.name, standard.name);
  EXPECT_EQ(read.scale.feature, standard.scale.feature);
  EXPECT_EQ(read.aspect_ratio.feature, standard.aspect_ratio.feature);
  EXPECT_EQ(read.baseline.feature, standard.baseline.feature);
  EXPECT_EQ(read.depth, standard.depth);
  EXPECT_EQ(read.mm_per_unit, standard.mm_per_unit);
  EXPECT_TRUE(read.components.empty());
}

TEST(SensorProfile, KeepsValuesAndTheirOrder) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("p.toml")) << R"(
name = "mine"
[setup]
settings = [["B", "1"], ["A", "2"]]
[[component]]
name = "Range"
enable = false
[depth]
meaning = "disparity"
chunks = true
[scan3d]
scale = 0.0625
focal_length = "MyFocalLength"
)";
  const auto p = load_sensor_profile(folder.file("p.toml"));
  ASSERT_EQ(p.settings.size(), 2u);
  EXPECT_EQ(p.settings[0].name, "B");
  EXPECT_FALSE(p.components.at(0).enable);
  EXPECT_EQ(p.depth, drivers::DepthMeaning::kDisparity);
  EXPECT_TRUE(p.chunks);
  EXPECT_EQ(p.scale.value, 0.0625);
  EXPECT_EQ(p.focal_length.feature, "MyFocalLength");
  EXPECT_FALSE(p.focal_length.value.has_value());
}

TEST(SensorProfile, FaultsNameTheLine) {
  EXPECT_TRUE(error_of("name = \"x\"\nnmae = \"y\"\n").starts_with(":2: there is no key \"nmae\""));
  EXPECT_TRUE(error_of("[depth]\nmeaning = \"deep\"\n").starts_with(":2: meaning: expected"));
  EXPECT_TRUE(
      error_of("[depth]\n\nmm_per_unit = -1\n").starts_with(":3: mm_per_unit is not a number"));
  EXPECT_TRUE(error_of("[scan3d]\nscale = nan\n").starts_with(":2: scale is neither"));
  EXPECT_TRUE(error_of("[setup]\nsettings = [[\"A\"]]\n").starts_with(":2: settings: expected"));
  EXPECT_TRUE(error_of("[[component]]\nenable = true\n").starts_with(":1: a component without"));
  EXPECT_TRUE(error_of("name = \n").starts_with(":1: "));
  EXPECT_THROW(load_sensor_profile("/no/such.toml"), SetupError);
}

}  // namespace
}  // namespace binpick::app
