#include "config/config_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "config/config_reader.hpp"
#include "config/pose_check.hpp"
#include "modbus/address_list.hpp"
#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

constexpr std::uintmax_t kFileBytesMax = 1 << 20;

std::string lines_of(const std::vector<ConfigFault>& faults) {
  std::string text;
  for (const ConfigFault& fault : faults) text += (text.empty() ? "" : "\n") + fault.text();
  return text;
}

std::optional<std::string> read_text(const std::string& path, std::vector<ConfigFault>& faults) {
  std::error_code error;
  const char* wrong = nullptr;
  if (!fs::is_regular_file(path, error)) wrong = "there is no such file";
  if (wrong == nullptr && fs::file_size(path, error) > kFileBytesMax)
    wrong = "is too large for a configuration file";
  if (wrong == nullptr) {
    std::ifstream file(path, std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (file || file.eof()) return text;
    wrong = "cannot be read";
  }
  faults.push_back({path, 0, 0, wrong});
  return std::nullopt;
}

std::string beside(const std::string& file, const std::string& name) {
  return (fs::path(file).parent_path() / name).lexically_normal().string();
}

// As a person goes through the file.
void sort_by_line(std::span<ConfigFault> faults) {
  std::stable_sort(faults.begin(), faults.end(), [](const ConfigFault& a, const ConfigFault& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

void check_addresses(const ModbusConfig& c, ConfigReader& reader) {
  const auto check = [&](const char* key, const std::string& text, auto parse) {
    try {
      parse(text);
    } catch (const SetupError& e) {
      reader.fault(key, e.what());
    }
  };
  check("modbus.bind", c.bind, modbus::parse_address);
  if (!c.writer.empty()) check("modbus.writer", c.writer, modbus::parse_address);
  for (const std::string& network : c.allow) check("modbus.allow", network, modbus::parse_network);
}

void check_main(const Config& c, ConfigReader& reader) {
  if (c.sensor.uri.empty()) reader.fault("sensor.uri", "must be set");
  if (c.station.recipes.empty()) reader.fault("station.recipes", "must name a file at least");
  if (c.sensor.reconnect_max_ms < c.sensor.reconnect_first_ms)
    reader.fault("sensor.reconnect_max_ms", "is less than sensor.reconnect_first_ms");
  check_addresses(c.modbus, reader);
  check_pose(kBaseCamKeys, c.station.T_base_cam, reader);
  check_pose(kFlangeCamKeys, c.station.T_flange_cam, reader);
  const bool real_time = c.threads.scheduling != Scheduling::kOther;
  if (real_time != (c.threads.priority > 0)) {
    const bool unset = real_time && !reader.wrote("threads.priority");
    reader.fault(unset ? "threads.scheduling" : "threads.priority",
                 unset       ? "needs threads.priority, 1 to 99"
                 : real_time ? "must be at least 1 with threads.scheduling"
                             : "has no meaning with threads.scheduling = \"other\"");
  }
  if (!isa_supported(c.threads.isa))
    reader.fault("threads.isa", "this processor does not have these instructions");
}

void check_recipe(const RecipeConfig& recipe, ConfigReader& reader) {
  if (recipe.number == 0 && !reader.wrote("number")) reader.fault("number", "must be set");
  if (recipe.models.empty()) reader.fault("models", "must name a file at least");
  check_pose(kPickKeys, recipe.T_obj_pick, reader);
  const auto& roi = recipe.roi_px;
  const bool none = std::all_of(roi.begin(), roi.end(), [](double v) { return v == 0; });
  if (!none && (roi[2] < 16 || roi[3] < 16))
    reader.fault("roi_px", "width and height must be at least 16, or all four 0");
  if (std::any_of(roi.begin(), roi.end(), [](double v) { return v != static_cast<int>(v); }))
    reader.fault("roi_px", "whole numbers are expected");
}

// What only the files together show.
void check_together(const Config& c, std::vector<ConfigFault>& faults) {
  const auto fault = [&](const std::string& file, const char* key, const std::string& message) {
    faults.push_back(fault_at(file, key, message));
  };
  for (std::size_t i = 0; i < c.recipes.size(); ++i) {
    const RecipeConfig& recipe = c.recipes[i];
    for (std::size_t k = 0; k < i; ++k) {
      if (c.recipes[k].number == recipe.number)
        fault(recipe.file, "number", "is that of " + c.recipes[k].file + " too");
    }
    if (recipe.roi_px[0] + recipe.roi_px[2] > c.sensor.width_max ||
        recipe.roi_px[1] + recipe.roi_px[3] > c.sensor.height_max)
      fault(recipe.file, "roi_px", "reaches beyond sensor.width_max and sensor.height_max");
    if (recipe.picks_max > c.station.picks_max)
      fault(recipe.file, "picks_max", "is more than station.picks_max");
  }
  const auto has = [&](const RecipeConfig& recipe) { return recipe.number == c.station.recipe; };
  if (c.station.recipe != 0 && std::none_of(c.recipes.begin(), c.recipes.end(), has))
    fault(c.file, "station.recipe", "no recipe has the number " + std::to_string(c.station.recipe));
}

}  // namespace

ConfigError::ConfigError(const std::vector<ConfigFault>& faults)
    : std::runtime_error(lines_of(faults)) {}

ConfigFault fault_at(const std::string& file, const std::string& key, const std::string& message) {
  std::vector<ConfigFault> faults;
  const std::string text = read_text(file, faults).value_or("");
  ConfigReader(text, file, faults).fault(key, message);
  return faults.back();
}

Config read_config_text(std::string_view text, const std::string& file,
                        std::vector<ConfigFault>& faults) {
  Config config;
  config.file = file;
  ConfigReader reader(text, file, faults);
  if (!reader.parsed()) return config;
  const std::size_t before = faults.size();
  visit_keys(config, reader);
  reader.finish();
  check_main(config, reader);
  sort_by_line(std::span(faults).subspan(before));
  return config;
}

RecipeConfig read_recipe_text(std::string_view text, const std::string& file,
                              std::vector<ConfigFault>& faults) {
  RecipeConfig recipe;
  recipe.file = file;
  ConfigReader reader(text, file, faults);
  if (!reader.parsed()) return recipe;
  const std::size_t before = faults.size();
  visit_keys(recipe, reader);
  reader.finish();
  check_recipe(recipe, reader);
  sort_by_line(std::span(faults).subspan(before));
  return recipe;
}

Config load_config(const std::string& path) {
  std::vector<ConfigFault> faults;
  Config config;
  if (const auto text = read_text(path, faults)) config = read_config_text(*text, path, faults);
  for (std::string& name : config.station.recipes) {
    name = beside(path, name);
    const auto text = read_text(name, faults);
    if (!text) continue;
    RecipeConfig recipe = read_recipe_text(*text, name, faults);
    for (std::string& model : recipe.models) model = beside(name, model);
    config.recipes.push_back(std::move(recipe));
  }
  for (std::string* name : {&config.sensor.camera_file, &config.sensor.profile}) {
    if (!name->empty()) *name = beside(path, *name);
  }
  if (faults.empty()) check_together(config, faults);
  if (!faults.empty()) throw ConfigError(faults);
  return config;
}

}  // namespace binpick::app
