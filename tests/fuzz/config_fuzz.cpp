// Configuration and recipe texts: whatever the bytes, there is an answer or faults with places, and
// values that passed are in their ranges.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/config_file.hpp"

namespace {

void check(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace binpick::app;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<ConfigFault> faults;
  const Config config = read_config_text(text, "fuzz.toml", faults);
  if (faults.empty()) check(!config.sensor.uri.empty() && !config.station.recipes.empty());
  check(config.sensor.width_max >= 16 && config.sensor.width_max <= 8192);
  check(config.station.picks_max >= 1 && config.station.picks_max <= 256);
  check(config.sensor.exposure_us >= 0 && config.sensor.exposure_us <= 1e7);
  check(config.modbus.port >= 0 && config.modbus.port <= 65535);
  for (const double v : config.station.T_base_cam.rotation_deg) check(v >= -360 && v <= 360);
  const ReloadLimits limits{1280, 1024, 640, 512};
  const ConfigChanges changes = compare(Config{}, config, limits);
  Config taken_over;
  take_live_values(taken_over, config, limits);
  check(compare(taken_over, config, limits).live.empty());
  check(compare(taken_over, Config{}, limits).live.size() == changes.live.size());
  faults.clear();
  const RecipeConfig recipe = read_recipe_text(text, "fuzz.toml", faults);
  check(recipe.min_score >= 0 && recipe.min_score <= 1);
  for (const ConfigFault& fault : faults) check(!fault.text().empty());
  return 0;
}
