// Hand-eye calibrations as people have them: which ways to write a transform are read, what is no
// rotation, and what --check warns about.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "config/config_file.hpp"
#include "config/config_writer.hpp"
#include "config/pose_check.hpp"
#include "station/recipe_set.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Config read(const std::string& station, std::vector<ConfigFault>& faults) {
  return read_config_text("[sensor]\nuri = 'replay:x'\n[station]\nrecipes = ['r.toml']\n" + station,
                          "f", faults);
}

// The camera looks down from (250, -40, 900), its x along the base's x.
const std::string kPosition = "T_base_cam_position_mm = [250, -40, 900]\n";
const char* const kWritten[] = {
    "T_base_cam_rotation_deg = [180, 0, 0]\n",
    "T_base_cam_quaternion_wxyz = [0, 1, 0, 0]\n",
    "T_base_cam_quaternion_xyzw = [1, 0, 0, 0]\n",
    "T_base_cam_quaternion_xyzw = [-0.9999, 0, 0, 0]\n",
};

TEST(Transforms, AreReadInEveryWay) {
  std::vector<std::string> all;
  for (const char* rotation : kWritten) all.push_back(kPosition + rotation);
  all.push_back(
      "T_base_cam_matrix = [[1, 0, 0, 250], [0, -1, 0, -40], [0, 0, -1, 900.0], [0, 0, 0, 1]]\n");
  for (const std::string& text : all) {
    std::vector<ConfigFault> faults;
    const Config config = read(text, faults);
    ASSERT_THAT(faults, IsEmpty()) << text << faults.front().text();
    const Pose T = pose_of(config.station.T_base_cam);
    const Vec3 seen = T * Vec3(10, 20, 800);
    EXPECT_NEAR(260, seen.x(), 1e-9) << text;
    EXPECT_NEAR(-60, seen.y(), 1e-9) << text;
    EXPECT_NEAR(100, seen.z(), 1e-9) << text;
  }
}

TEST(Transforms, ARecipeReadsThemToo) {
  std::vector<ConfigFault> faults;
  const RecipeConfig recipe = read_recipe_text(
      "number = 1\nmodels = ['m.bpm']\nT_obj_pick_quaternion_wxyz = [0.5, 0.5, 0.5, 0.5]\n", "r",
      faults);
  ASSERT_THAT(faults, IsEmpty());
  EXPECT_NEAR(1, (pose_of(recipe.T_obj_pick) * Vec3(1, 0, 0)).y(), 1e-12);
}

TEST(Transforms, AreWrittenOutAsTheyWereRead) {
  std::vector<ConfigFault> faults;
  const Config config = read(
      "T_base_cam_matrix = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 300], [0, 0, 0, 1]]\n"
      "T_flange_cam_quaternion_xyzw = [0, 0, 0, 1]\n",
      faults);
  const Config again = read_config_text(written_config(config), "g", faults);
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_EQ(config.station.T_base_cam.matrix, again.station.T_base_cam.matrix);
  EXPECT_THAT(again.station.T_flange_cam.quaternion_xyzw, ElementsAre(0, 0, 0, 1));
  EXPECT_THAT(compare(config, again, {}).live, IsEmpty());
}

// A reload takes them over.
TEST(Transforms, AreLive) {
  std::vector<ConfigFault> faults;
  Config running = read("", faults);
  const Config wanted = read("T_base_cam_quaternion_wxyz = [0, 1, 0, 0]\n", faults);
  EXPECT_THAT(compare(running, wanted, {}).live, ElementsAre("station.T_base_cam_quaternion_wxyz"));
  take_live_values(running, wanted, {});
  EXPECT_THAT(running.station.T_base_cam.quaternion_wxyz, ElementsAre(0, 1, 0, 0));
}

const std::pair<const char*, const char*> kFaults[] = {
    {"T_base_cam_quaternion_wxyz = [1, 1, 0, 0]", "is no rotation: its length is 1.414"},
    {"T_base_cam_quaternion_xyzw = [0, 0, 0, 0]", "is no rotation: its length is 0"},
    {"T_base_cam_quaternion_wxyz = [1, 0, 0]", "a list of 4 numbers"},
    {"T_base_cam_matrix = [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]", "it mirrors"},
    {"T_base_cam_matrix = [[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]", "orthogonal unit vectors"},
    {"T_base_cam_matrix = [[1,0,0,0],[0,1,0,0],[0,0,1,0],[10,20,30,1]]", "write it row by row"},
    {"T_base_cam_matrix = [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]", "its last row is not"},
    {"T_base_cam_matrix = [[1,0,0,0],[0,1,0,0],[0,0,1,0]]", "a list of 4 rows of 4 numbers"},
    {"T_base_cam_matrix = [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]", "a list of 4 rows of 4 numbers"},
    {"T_base_cam_quaternion_wxyz = [0,1,0,0]\nT_base_cam_rotation_deg = [180,0,0]",
     "in another way too: leave one"},
    {"T_base_cam_quaternion_wxyz = [0,1,0,0]\nT_base_cam_quaternion_xyzw = [1,0,0,0]",
     "in another way too: leave one"},
    {"T_base_cam_matrix = [[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]\n"
     "T_base_cam_position_mm = [5, 6, 7]",
     "leave out station.T_base_cam_position_mm"},
};

TEST(Transforms, WhatIsNoRotationIsOneFaultWithItsPlace) {
  for (const auto& [text, says] : kFaults) {
    std::vector<ConfigFault> faults;
    read(std::string(text) + "\n", faults);
    ASSERT_EQ(1u, faults.size()) << text;
    EXPECT_THAT(faults[0].text(), HasSubstr(says)) << text;
    EXPECT_THAT(faults[0].text(), HasSubstr("f:5:1: station.T_base_cam")) << text;
  }
}

const std::pair<const char*, std::vector<std::string>> kWarnings[] = {
    {"T_base_cam_position_mm = [250, -40, 900]\nT_base_cam_rotation_deg = [180, 0, 0]", {}},
    {"T_base_cam_position_mm = [0.25, -0.04, 0.9]\nT_base_cam_rotation_deg = [180, 0, 0]",
     {"5:1: station.T_base_cam_position_mm: the position looks like metres"}},
    {"T_base_cam_matrix = [[1,0,0,0.25],[0,-1,0,0],[0,0,-1,0.9],[0,0,0,1]]",
     {"5:1: station.T_base_cam_matrix: the position looks like metres"}},
    {"T_base_cam_position_mm = [250, -40, 900]\nT_base_cam_rotation_deg = [3.1416, 0, -1.57]",
     {"6:1: station.T_base_cam_rotation_deg: looks like radians"}},
    {"T_flange_cam_position_mm = [0.02, 0, 0.11]\nT_flange_cam_rotation_deg = [0, 0, 1.5708]",
     {"5:1: station.T_flange_cam_position_mm: the position looks like metres",
      "6:1: station.T_flange_cam_rotation_deg: looks like radians"}},
    {"pose_frame = 'base'",
     {"5:1: station.pose_frame: is \"base\", but T_base_cam is the identity"}},
    {"pose_frame = 'base'\nmounting = 'flange'\nT_base_cam_position_mm = [250, -40, 900]",
     {"5:1: station.pose_frame: is \"base\", but T_flange_cam is the identity"}},
    {"pose_frame = 'base'\nT_base_cam_rotation_deg = [180, 0, 0]", {}},
    {"T_base_cam_rotation_deg = [0.1, -0.05, 0]", {}},
};

TEST(Transforms, WhatIsUnlikelyIsWarnedAbout) {
  const TemporaryFolder folder;
  for (const auto& [text, expected] : kWarnings) {
    std::vector<ConfigFault> faults;
    Config config = read(std::string(text) + "\n", faults);
    ASSERT_THAT(faults, IsEmpty()) << text;
    config.file = folder.file("station.toml");
    std::ofstream(config.file) << "[sensor]\nuri = 'replay:x'\n[station]\nrecipes = ['r.toml']\n"
                               << text << "\n";
    const std::vector<ConfigFault> warnings = pose_warnings(config);
    ASSERT_EQ(expected.size(), warnings.size()) << text;
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_THAT(warnings[i].text(), HasSubstr(expected[i])) << text;
  }
}

}  // namespace
}  // namespace binpick::app
