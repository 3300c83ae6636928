#include "sensor/sensor_profile_file.hpp"

// As everywhere: with exceptions here and without them elsewhere the program would hold two halves
// of two parsers.
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

using drivers::ComponentSetting;
using drivers::DepthMeaning;
using drivers::FeatureOrValue;
using drivers::FeatureSetting;
using drivers::SensorProfile;

[[noreturn]] void fail(const std::string& path, const toml::node& node, const std::string& what) {
  throw SetupError(path + ":" + std::to_string(node.source().begin.line) + ": " + what);
}

using Reader = std::function<void(const toml::node& node, const std::string& key)>;
using Readers = std::map<std::string, Reader>;

// Each key once, known ones only.
void read_table(const std::string& path, const toml::table& table, const Readers& readers) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const auto reader = readers.find(name);
    if (reader == readers.end()) {
      std::string known;
      for (const auto& [k, r] : readers) known += (known.empty() ? "" : ", ") + k;
      fail(path, node, "there is no key \"" + name + "\" here; known are " + known);
    }
    reader->second(node, name);
  }
}

class ProfileReader {
 public:
  explicit ProfileReader(std::string path) : path_(std::move(path)) {}

  SensorProfile read(const toml::table& root) {
    read_table(
        path_, root,
        {{"name", text(profile_.name)},
         {"match", table([this](const toml::table& t) { read_match(t); })},
         {"setup", table([this](const toml::table& t) { read_setup(t); })},
         {"component", [this](const toml::node& n, const std::string&) { read_components(n); }},
         {"depth", table([this](const toml::table& t) { read_depth(t); })},
         {"scan3d", table([this](const toml::table& t) { read_scan3d(t); })}});
    return profile_;
  }

 private:
  Reader text(std::string& value) const {
    return [this, &value](const toml::node& node, const std::string& key) {
      if (!node.is_string()) fail(path_, node, key + " is not a text");
      value = node.value_or(std::string());
    };
  }
  Reader flag(bool& value) const {
    return [this, &value](const toml::node& node, const std::string& key) {
      if (!node.is_boolean()) fail(path_, node, key + " is neither true nor false");
      value = node.value_or(false);
    };
  }
  Reader number(double& value, double min, double max) const {
    return [this, &value, min, max](const toml::node& node, const std::string& key) {
      const auto read = node.is_number() ? node.value<double>() : std::nullopt;
      if (!read || !(*read >= min && *read <= max))
        fail(path_, node,
             key + " is not a number from " + std::to_string(min) + " to " + std::to_string(max));
      value = *read;
    };
  }
  Reader source(FeatureOrValue& value) const {
    return [this, &value](const toml::node& node, const std::string& key) {
      if (node.is_string()) {
        value = {node.value_or(std::string()), {}};
      } else if (node.is_number() && std::isfinite(node.value_or(0.0))) {
        value.value = node.value_or(0.0);
      } else {
        fail(path_, node, key + " is neither a feature's name nor a number");
      }
    };
  }
  Reader table(std::function<void(const toml::table&)> read) const {
    return [this, read](const toml::node& node, const std::string& key) {
      if (!node.is_table()) fail(path_, node, key + " is not a table");
      read(*node.as_table());
    };
  }
  // [["Feature", "value"], ...]: a list, since the order matters.
  Reader settings(std::vector<FeatureSetting>& values) const {
    return [this, &values](const toml::node& node, const std::string& key) {
      if (!node.is_array()) fail(path_, node, key + " is not a list");
      for (const toml::node& entry : *node.as_array()) {
        const toml::array* pair = entry.as_array();
        if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_string() ||
            !(*pair)[1].is_string())
          fail(path_, entry, key + ": expected [\"Feature\", \"value\"]");
        values.push_back({(*pair)[0].value_or(std::string()), (*pair)[1].value_or(std::string())});
      }
    };
  }

  void read_match(const toml::table& t) {
    read_table(path_, t, {{"vendor", text(profile_.vendor)}, {"model", text(profile_.model)}});
  }
  void read_setup(const toml::table& t) {
    read_table(path_, t,
               {{"pixel_format", text(profile_.pixel_format)},
                {"settings", settings(profile_.settings)},
                {"optional_settings", settings(profile_.optional_settings)}});
  }
  void read_components(const toml::node& node) {
    if (!node.is_array_of_tables()) fail(path_, node, "component: expected [[component]]");
    for (const toml::node& entry : *node.as_array()) {
      ComponentSetting component;
      read_table(path_, *entry.as_table(),
                 {{"name", text(component.name)},
                  {"enable", flag(component.enable)},
                  {"optional", flag(component.optional)},
                  {"pixel_format", text(component.pixel_format)}});
      if (component.name.empty()) fail(path_, entry, "a component without a name");
      profile_.components.push_back(component);
    }
  }
  void read_depth(const toml::table& t) {
    const Reader meaning = [this](const toml::node& node, const std::string& key) {
      const std::string value = node.value_or(std::string());
      if (value == "output-mode") {
        profile_.depth = DepthMeaning::kFromOutputMode;
      } else if (value == "z") {
        profile_.depth = DepthMeaning::kZ;
      } else if (value == "disparity") {
        profile_.depth = DepthMeaning::kDisparity;
      } else {
        fail(path_, node, key + ": expected \"output-mode\", \"z\" or \"disparity\"");
      }
    };
    read_table(path_, t,
               {{"meaning", meaning},
                {"mono16_is_depth", flag(profile_.mono16_is_depth)},
                {"mm_per_unit", number(profile_.mm_per_unit, 1e-6, 1e6)},
                {"baseline_unit_mm", number(profile_.baseline_unit_mm, 1e-6, 1e6)},
                {"principal_point_shift_px", number(profile_.principal_point_shift_px, -1, 1)},
                {"confidence_min", number(profile_.confidence_min, 0, 1)},
                {"chunks", flag(profile_.chunks)}});
  }
  void read_scan3d(const toml::table& t) {
    read_table(path_, t,
               {{"scale", source(profile_.scale)},
                {"offset", source(profile_.offset)},
                {"invalid_flag", source(profile_.invalid_flag)},
                {"invalid_value", source(profile_.invalid_value)},
                {"focal_length", source(profile_.focal_length)},
                {"aspect_ratio", source(profile_.aspect_ratio)},
                {"principal_u", source(profile_.principal_u)},
                {"principal_v", source(profile_.principal_v)},
                {"baseline", source(profile_.baseline)}});
  }

  std::string path_;
  SensorProfile profile_;
};

}  // namespace

SensorProfile load_sensor_profile(const std::string& path) {
  const toml::parse_result parsed = toml::parse_file(path);
  if (!parsed) {
    const toml::parse_error& e = parsed.error();
    throw SetupError(path + ":" + std::to_string(e.source().begin.line) + ": " +
                     std::string(e.description()));
  }
  return ProfileReader(path).read(parsed.table());
}

std::vector<SensorProfile> load_sensor_profiles(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<SensorProfile> profiles;
  for (const std::string& path : paths) profiles.push_back(load_sensor_profile(path));
  return profiles;
}

const SensorProfile* find_profile(const std::vector<SensorProfile>& profiles,
                                  const std::string& vendor, const std::string& model) {
  for (const SensorProfile& p : profiles) {
    if (p.vendor.empty() && p.model.empty()) continue;
    if (vendor.starts_with(p.vendor) && model.starts_with(p.model)) return &p;
  }
  return nullptr;
}

}  // namespace binpick::app
