// Configuration files: what is read, what is refused and where, and that the documented file names
// every key with its default.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "config/config_file.hpp"
#include "config/config_writer.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// The faults of a main file whose required keys are set.
std::vector<std::string> faults_of(const std::string& text) {
  std::vector<ConfigFault> faults;
  read_config_text(text, "f", faults);
  std::vector<std::string> lines;
  for (const ConfigFault& fault : faults) lines.push_back(fault.text());
  std::erase(lines, "f: sensor.uri: must be set");
  std::erase(lines, "f: station.recipes: must name a file at least");
  return lines;
}

std::vector<std::string> names_in(const std::string& path) {
  std::vector<ConfigFault> faults;
  const TomlValues values = parse_toml(text_of(path), path, faults);
  EXPECT_THAT(faults, IsEmpty());
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

TEST(ConfigDocumentation, NamesEveryKeyExactlyAndItsDefault) {
  const std::string main = BINPICK_FIRMWARE_CONFIG "/binpick.toml";
  EXPECT_THAT(names_in(main), testing::UnorderedElementsAreArray(config_key_names()));
  std::vector<ConfigFault> faults;
  const Config config = read_config_text(text_of(main), main, faults);
  for (const ConfigFault& fault : faults) EXPECT_THAT(fault.message, HasSubstr("must "));
  const ConfigChanges changes = compare(Config{}, config, {});
  EXPECT_THAT(changes.live, IsEmpty());
  EXPECT_THAT(changes.restart, IsEmpty());

  const std::string recipe_file = BINPICK_FIRMWARE_CONFIG "/recipes/example.toml";
  EXPECT_THAT(names_in(recipe_file), testing::UnorderedElementsAreArray(recipe_key_names()));
  faults.clear();
  Config documented, defaults;
  documented.recipes = {read_recipe_text(text_of(recipe_file), recipe_file, faults)};
  defaults.recipes = {RecipeConfig{}};
  EXPECT_THAT(compare(defaults, documented, {}).live, IsEmpty());
  EXPECT_THAT(compare(defaults, documented, {}).restart, IsEmpty());
}

TEST(Config, ReadsEachKind) {
  std::vector<ConfigFault> faults;
  const Config c = read_config_text(
      "sensor.uri = 'gev://192.168.1.5'\n[station]\nrecipes = ['a.toml', 'b.toml']\n"
      "T_base_cam_position_mm = [1, -2.5, 3]\nranking = 'high_base'\nfault_latched = true\n"
      "[sensor]\n",
      "f", faults);
  EXPECT_EQ(1u, faults.size());  // [sensor] after sensor.uri is no TOML
  faults.clear();
  const Config d = read_config_text(
      "[station]\nrecipes = ['a.toml', 'b.toml']\nT_base_cam_position_mm = [1, -2.5, 3]\n"
      "ranking = 'high_base'\nfault_latched = true\n[threads]\ncpus = [2, 3]\n[sensor]\n"
      "uri = 'gev://192.168.1.5'\nexposure_us = 12\n",
      "f", faults);
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_EQ("gev://192.168.1.5", d.sensor.uri);
  EXPECT_EQ(12, d.sensor.exposure_us);
  EXPECT_THAT(d.station.recipes, ElementsAre("a.toml", "b.toml"));
  EXPECT_THAT(d.station.T_base_cam.position_mm, ElementsAre(1, -2.5, 3));
  EXPECT_EQ(Ranking::kHighBase, d.station.ranking);
  EXPECT_TRUE(d.station.fault_latched);
  EXPECT_THAT(d.threads.cpus, ElementsAre(2, 3));
  EXPECT_EQ(Config{}.station.deadline_ms, d.station.deadline_ms);
}

TEST(Config, NamesEveryFaultWithItsPlace) {
  EXPECT_THAT(
      faults_of("[station]\ndeadline_ms = 60001\n  picks_max = 'ten'\nfree_run = 1\n"
                "ranking = 'best'\nT_base_cam_position_mm = [1, 2]\n[threads]\ncpus = [0, -1]\n"),
      ElementsAre("f:2:1: station.deadline_ms: 60001 is outside of 0 to 60000 in ms",
                  "f:3:3: station.picks_max: text stands where a whole number is expected",
                  "f:4:1: station.free_run: a whole number stands where true or false is expected",
                  "f:5:1: station.ranking: 'best' is none of score, near_camera, high_base",
                  "f:6:1: station.T_base_cam_position_mm: a list of 2 stands where a list of 3 "
                  "numbers in mm is expected",
                  "f:8:1: threads.cpus: -1 is outside of 0 to 1023"))
      << "all of them in one go";
}

TEST(Config, AKeyInAnotherUnitIsToldTheRightOne) {
  EXPECT_THAT(faults_of("station.deadline_s = 1\n"),
              ElementsAre("f:1:9: station.deadline_s: there is no such key: the key is "
                          "station.deadline_ms, in ms"));
  EXPECT_THAT(faults_of("station.deadline_ms = '1 s'\n"),
              ElementsAre("f:1:9: station.deadline_ms: text stands where a whole number in ms is "
                          "expected"));
  EXPECT_THAT(faults_of("[senzor]\nuri = 'x'\n"),
              ElementsAre("f:2:1: senzor.uri: there is no such key: is sensor.uri meant?"));
}

TEST(Config, RefusesNumbersThatAreNone) {
  for (const char* value : {"nan", "inf", "-inf", "1e300"}) {
    EXPECT_EQ(1u, faults_of(std::string("sensor.exposure_us = ") + value + "\n").size()) << value;
  }
  EXPECT_EQ(1u, faults_of("station.picks_max = 9223372036854775807\n").size());
  EXPECT_EQ(1u, faults_of("station.picks_max = 3.0\n").size());
}

TEST(Config, ASyntaxErrorHasItsPlace) {
  const auto faults = faults_of("[station]\nranking = \n");
  ASSERT_EQ(1u, faults.size());
  EXPECT_THAT(faults[0], testing::StartsWith("f:2:"));
}

TEST(Config, PriorityGoesWithRealTimeScheduling) {
  EXPECT_EQ(1u, faults_of("threads.priority = 5\n").size());
  EXPECT_EQ(1u, faults_of("threads.scheduling = 'fifo'\n").size());
  EXPECT_THAT(faults_of("threads.scheduling = 'fifo'\nthreads.priority = 5\n"), IsEmpty());
}

struct ConfigFolder {
  TemporaryFolder folder;
  std::string path(const std::string& name) const { return folder.path() + "/" + name; }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(path(name)) << text;
  }
  std::string error() {
    try {
      load_config(path("binpick.toml"));
      return "";
    } catch (const ConfigError& e) {
      return e.what();
    }
  }
};

constexpr const char* kTwoRecipes =
    "sensor.uri = 'replay:x'\nstation.recipes = ['a.toml', 'b.toml']\n";

TEST(ConfigFiles, RecipesAreReadFromBesideTheMainFile) {
  ConfigFolder f;
  f.write("binpick.toml", kTwoRecipes);
  f.write("a.toml", "number = 3\nmodels = ['tee.bpm']\nroi_px = [10, 20, 300, 200]\n");
  f.write("b.toml",
          "number = 1\nmodels = ['/opt/hub.bpm']\nmin_score = 0.25\nmodality = 'intensity'\n"
          "near_symmetry = 'equivalent'\n");
  const Config c = load_config(f.path("binpick.toml"));
  ASSERT_EQ(2u, c.recipes.size());
  EXPECT_EQ(3, c.recipes[0].number);
  EXPECT_THAT(c.recipes[0].models, ElementsAre(f.path("tee.bpm")));
  EXPECT_THAT(c.recipes[1].models, ElementsAre("/opt/hub.bpm"));
  EXPECT_EQ(0.25, c.recipes[1].min_score);
  EXPECT_EQ(Modality::kAutomatic, c.recipes[0].modality);
  EXPECT_EQ(Modality::kIntensity, c.recipes[1].modality);
  EXPECT_EQ(NearSymmetry::kAuto, c.recipes[0].near_symmetry);
  EXPECT_EQ(NearSymmetry::kEquivalent, c.recipes[1].near_symmetry);
}

TEST(ConfigFiles, TheFaultsOfAllFilesComeInOneGo) {
  ConfigFolder f;
  f.write("binpick.toml", std::string(kTwoRecipes) + "station.rankin = 'score'\n");
  f.write("a.toml",
          "models = []\nmin_score = 2\nmodality = 'gray'\n"
          "near_symmetry = true\n");
  EXPECT_THAT(f.error(), HasSubstr("binpick.toml:3:9: station.rankin: there is no such key"));
  EXPECT_THAT(f.error(), HasSubstr("a.toml:2:1: min_score: 2 is outside of 0 to 1"));
  EXPECT_THAT(f.error(), HasSubstr("a.toml:3:1: modality: 'gray' is none of automatic, "
                                   "depth_and_intensity, depth, intensity"));
  EXPECT_THAT(f.error(), HasSubstr("a.toml:4:1: near_symmetry:"));
  EXPECT_THAT(f.error(), HasSubstr("a.toml: number: must be set"));
  EXPECT_THAT(f.error(), HasSubstr("a.toml:1:1: models: must name a file at least"));
  EXPECT_THAT(f.error(), HasSubstr("b.toml: there is no such file"));
}

TEST(ConfigFiles, RefusesWhatDoesNotFitTogether) {
  ConfigFolder f;
  f.write("binpick.toml", std::string(kTwoRecipes) + "station.recipe = 9\n");
  f.write("a.toml", "number = 1\nmodels = ['m']\nroi_px = [1000, 0, 300, 200]\n");
  f.write("b.toml", "number = 1\nmodels = ['m']\npicks_max = 65\n");
  EXPECT_THAT(f.error(), HasSubstr("a.toml:3:1: roi_px: reaches beyond"));
  EXPECT_THAT(f.error(), HasSubstr("b.toml:1:1: number: is that of "));
  EXPECT_THAT(f.error(), HasSubstr("b.toml:3:1: picks_max: is more than"));
  EXPECT_THAT(f.error(), HasSubstr("binpick.toml:3:9: station.recipe: no recipe has the number 9"));
}

TEST(ConfigChanges, KnowsWhatNeedsARestart) {
  Config a, b;
  a.recipes = b.recipes = {RecipeConfig{}};
  b.station.deadline_ms = 100;
  b.sensor.width_max = 640;
  b.recipes[0].min_score = 0.6;
  b.recipes[0].modality = Modality::kDepth;
  b.recipes[0].number = 2;
  const ConfigChanges changes = compare(a, b, {});
  EXPECT_THAT(changes.live,
              ElementsAre("station.deadline_ms", "recipe 0: modality", "recipe 0: min_score"));
  EXPECT_THAT(changes.restart, ElementsAre("sensor.width_max", "recipe 0: number"));
}

TEST(Config, ComesBackAsItWasWritten) {
  Config a;
  a.sensor.uri = "replay:a \"quoted\" \\ name\twith\x7F more";
  a.sensor.gain = 0.1;
  a.station.recipes = {"one.toml", "/two.toml"};
  a.station.T_base_cam.position_mm = {1, -1e-9, 12345.678901234567};
  a.station.ranking = Ranking::kHighBase;
  a.modbus.allow = {"10.0.0.0/8"};
  a.modbus.encoding.word_order = modbus::map::WordOrder::kDcba;
  a.threads.cpus = {0, 3};
  a.recorder.mode = RecordMode::kAlways;
  a.recipes.resize(1);
  a.recipes[0].number = 65535;
  a.recipes[0].models = {"a.bpm", "b.bpm"};
  a.recipes[0].roi_px = {1, 2, 300, 400};
  std::vector<ConfigFault> faults;
  Config b = read_config_text(written_config(a), "a", faults);
  b.recipes = {read_recipe_text(written_recipe(a.recipes[0]), "r", faults)};
  for (const ConfigFault& fault : faults) ADD_FAILURE() << fault.text();
  const ConfigChanges changes = compare(a, b, {});
  EXPECT_THAT(changes.live, IsEmpty());
  EXPECT_THAT(changes.restart, IsEmpty());
}

TEST(Config, ARegionIsLiveAsFarAsTheMemoryGoes) {
  constexpr ReloadLimits kLimits{640, 480, 320, 240};
  Config a;
  a.recipes.resize(1);
  a.recipes[0].roi_px = {10, 10, 320, 240};
  const auto live = [&](const std::array<double, 4>& roi_px) {
    Config running = a, wanted = a;
    wanted.recipes[0].roi_px = roi_px;
    const ConfigChanges changes = compare(running, wanted, kLimits);
    take_live_values(running, wanted, kLimits);
    const bool taken = running.recipes[0].roi_px == roi_px;
    EXPECT_THAT(taken ? changes.live : changes.restart, ElementsAre("recipe 0: roi_px"));
    EXPECT_THAT(taken ? changes.restart : changes.live, IsEmpty());
    return taken;
  };
  EXPECT_TRUE(live({200, 100, 320, 240}));
  EXPECT_TRUE(live({200, 100, 16, 16}));
  EXPECT_FALSE(live({0, 0, 321, 240}));
  EXPECT_FALSE(live({0, 0, 320, 241}));
  EXPECT_FALSE(live({0, 0, 0, 0})) << "the whole image";
}

}  // namespace
}  // namespace binpick::app
