// What kind of 3D sensor is simulated: the features it starts with, after makers' sensors.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "feature_map.hpp"

namespace binpick::sim {

struct Personality {
  const char* name;         // as given on the command line
  const char* description;  // one line for --help
  std::uint32_t range_format, intensity_format, confidence_format;
  std::array<bool, kComponentCount> enabled = {true, true, false};  // at start
  std::uint32_t output_mode = kProjectedC;
  std::uint32_t distance_unit = kMillimeter;
  bool chunks_active = false;
  double scale_c = 0;  // 0: depth_scale of the scenes
  double invalid_value = 0;
  double baseline_m = 0;
  const char* range_component = "Range";  // its entry in ComponentSelector
  std::uint32_t range_component_id = 4;   // SFNC ComponentIDValue
};

std::span<const Personality> personalities();

// nullptr when there is none of this name.
const Personality* find_personality(const std::string& name);

}  // namespace binpick::sim
