// The kinds of 3D sensors that look into bins, each with the faults that it is known for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/depth_sensor.hpp"

namespace binpick::simulation {

enum class SensorKind {
  kActiveStereo,     // two eyes and a pattern: depth spreads over edges
  kPassiveStereo,    // consumer stereo: smoothed, gaps filled, noisy where there is no texture
  kStructuredLight,  // precise; nothing at steps, where metal shines or sends the light away
  kTimeOfFlight,     // no shadows; flying pixels at steps, walls and corners rounded by echoes
};
inline constexpr std::array kSensorKinds = {SensorKind::kActiveStereo, SensorKind::kPassiveStereo,
                                            SensorKind::kStructuredLight,
                                            SensorKind::kTimeOfFlight};

const char* sensor_kind_name(SensorKind kind);  // snake_case
std::vector<std::string> sensor_kind_names();
std::optional<SensorKind> sensor_kind_of(std::string_view name);

DepthSensorParams sensor_params(SensorKind kind);

}  // namespace binpick::simulation
