#include "replay/recording.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "config/config_file.hpp"
#include "setup_error.hpp"

namespace fs = std::filesystem;
using nlohmann::json;

namespace binpick::app {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw SetupError(path + ": cannot be read");
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

template <std::size_t N>
void read_registers(const json& list, std::array<std::uint16_t, N>& registers) {
  if (list.size() != N) throw SetupError(std::to_string(list.size()) + " registers");
  for (std::size_t i = 0; i < N; ++i) registers[i] = list.at(i).get<std::uint16_t>();
}

RecordedCycle cycle_of(const std::string& line) {
  const json entry = json::parse(line);
  RecordedCycle cycle;
  cycle.cycle = entry.at("cycle").get<std::uint64_t>();
  cycle.cause = static_cast<modbus::map::Cause>(entry.at("cause").get<std::uint16_t>());
  if (entry.contains("image")) cycle.image = entry.at("image").get<int>();
  cycle.record = entry.value("record", std::uint64_t{0});
  cycle.order = entry.value("order", "");
  cycle.recipe_selected = entry.value("recipe_selected", 0);
  read_registers(entry.at("command"), cycle.command);
  read_registers(entry.at("answer"), cycle.answer);
  return cycle;
}

void read_cycles(const std::string& path, Recording& recording) {
  const std::string text = text_of(path);
  int number = 0;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = text.find('\n', begin);
    recording.cut_off = end == std::string::npos;
    if (recording.cut_off) return;
    try {
      recording.cycles.push_back(cycle_of(text.substr(begin, end - begin)));
    } catch (const std::exception& e) {
      throw SetupError(path + ":" + std::to_string(number + 1) + ": is no cycle: " + e.what());
    }
    begin = end + 1;
  }
}

void read_head(const std::string& path, Recording& recording) {
  try {
    const json head = json::parse(text_of(path));
    if (const int format = head.at("format").get<int>(); format != 1)
      throw SetupError("format " + std::to_string(format) + " is not known");
    for (const json& model : head.at("models"))
      recording.models.push_back({model.at("recipe").get<int>(), model.at("path"),
                                  std::stoull(model.at("hash").get<std::string>(), nullptr, 16)});
  } catch (const std::exception& e) {
    throw SetupError(path + ": is no recording of a station: " + e.what());
  }
}

std::string found_model(const std::string& path, const std::string& models_folder) {
  std::error_code error;
  if (models_folder.empty() || fs::exists(path, error)) return path;
  return (fs::path(models_folder) / fs::path(path).filename()).string();
}

}  // namespace

Recording load_recording(const std::string& folder) {
  Recording recording;
  recording.folder = folder;
  read_head(folder + "/recording.json", recording);
  read_cycles(folder + "/cycles.jsonl", recording);
  if (recording.cycles.empty()) throw SetupError(folder + ": holds no cycle");
  return recording;
}

Config recorded_config(const Recording& recording, const std::string& models_folder) {
  const std::string folder = recording.folder + "/configuration";
  std::vector<ConfigFault> faults;
  const std::string main = folder + "/binpick.toml";
  Config config = read_config_text(text_of(main), main, faults);
  for (std::size_t i = 0; i < config.station.recipes.size(); ++i) {
    const std::string file = folder + "/recipes/" + std::to_string(i + 1) + ".toml";
    RecipeConfig recipe = read_recipe_text(text_of(file), file, faults);
    recipe.models.clear();
    for (const Recording::Model& model : recording.models) {
      if (model.recipe == static_cast<int>(i) + 1)
        recipe.models.push_back(found_model(model.path, models_folder));
    }
    config.recipes.push_back(std::move(recipe));
  }
  if (!faults.empty()) throw ConfigError(faults);
  return config;
}

}  // namespace binpick::app
