// The configuration of a station, read from its main file and the recipe files that it names, and
// checked. All faults are collected. Set-up, and reloading on the main thread: it allocates.
#pragma once

#include <stdexcept>
#include <string_view>

#include "config/config.hpp"
#include "config/toml_file.hpp"

namespace binpick::app {

struct ConfigError : std::runtime_error {
  explicit ConfigError(const std::vector<ConfigFault>& faults);
};

// A fault of the file at the place of `key`; of the file as a whole where it is not written. Reads
// the file anew: only who has a fault pays for it.
ConfigFault fault_at(const std::string& file, const std::string& key, const std::string& message);

// Throws ConfigError with a line a fault: unreadable files, syntax, unknown keys, wrong types,
// values out of range, values that contradict each other. Relative names of files become paths.
Config load_config(const std::string& path);

// The parts of it that read no files.
Config read_config_text(std::string_view text, const std::string& file,
                        std::vector<ConfigFault>& faults);
RecipeConfig read_recipe_text(std::string_view text, const std::string& file,
                              std::vector<ConfigFault>& faults);

// What the memory of a running station was taken for, px.
struct ReloadLimits {
  int image_width = 0, image_height = 0;
  int roi_width = 0, roi_height = 0;  // the largest region that a recipe can have
};

// The keys in which two configurations differ, recipes as "recipe 3: roi_px"; in `restart` those
// that a running station cannot take over, in `live` those that it can.
struct ConfigChanges {
  std::vector<std::string> live, restart;
};
ConfigChanges compare(const Config& running, const Config& wanted, const ReloadLimits& limits);

// Gives `running` the values of `wanted` that a running station can take over; recipes only where
// both have the same numbers in the same order.
void take_live_values(Config& running, const Config& wanted, const ReloadLimits& limits);

// Every key of the main file, or of a recipe file, in order of the list.
std::vector<std::string> config_key_names();
std::vector<std::string> recipe_key_names();

}  // namespace binpick::app
