#include "simulation/sensor_kind.hpp"

#include <algorithm>

namespace binpick::simulation {

const char* sensor_kind_name(SensorKind kind) {
  switch (kind) {
    case SensorKind::kActiveStereo:
      return "active_stereo";
    case SensorKind::kPassiveStereo:
      return "passive_stereo";
    case SensorKind::kStructuredLight:
      return "structured_light";
    case SensorKind::kTimeOfFlight:
      return "time_of_flight";
  }
  return "";
}

std::vector<std::string> sensor_kind_names() {
  std::vector<std::string> names;
  for (const SensorKind kind : kSensorKinds) names.emplace_back(sensor_kind_name(kind));
  return names;
}

std::optional<SensorKind> sensor_kind_of(std::string_view name) {
  const auto* found = std::find_if(kSensorKinds.begin(), kSensorKinds.end(),
                                   [&](SensorKind k) { return name == sensor_kind_name(k); });
  if (found == kSensorKinds.end()) return std::nullopt;
  return *found;
}

DepthSensorParams sensor_params(SensorKind kind) {
  DepthSensorParams p;
  switch (kind) {
    case SensorKind::kActiveStereo:
      break;
    case SensorKind::kPassiveStereo:
      p.shadow_of_pattern = false;
      p.noise_px = 0.09;
      p.drift_px = 0.12;
      p.plain_factor = 3;
      p.fattening_px = 4.5;
      p.window_px = 4;
      p.window_mm = 5;
      p.dark_level = 0;
      p.outlier_share = 0.001;
      p.filled_gap_px = 40;
      break;
    case SensorKind::kStructuredLight:
      p.shadow_of_pattern = false;
      p.noise_px = 0.025;
      p.drift_px = 0.03;
      p.disparity_step_px = 1.0 / 128;
      p.fattening_px = 0;
      p.edge_px = 1.5;
      p.window_px = 1;
      p.window_mm = 1;
      p.grazing_cos_min = 0.08;
      p.grazing_cos_sure = 0.25;
      p.glare_level = 0.8;
      p.dark_level = 0.035;
      p.by_own_light = true;
      p.metal_multipath = 0.12;
      p.outlier_share = 0.001;
      break;
    case SensorKind::kTimeOfFlight:
      p.second_ray = false;
      p.shadow_of_pattern = false;
      p.noise_px = 0.3;
      p.drift_px = 0.25;
      p.fattening_px = 0;
      p.window_px = 1;
      p.window_mm = 1e6;
      p.grazing_cos_min = 0.05;
      p.grazing_cos_sure = 0.15;
      p.glare_level = 1.5;
      p.dark_level = 0;
      p.by_own_light = true;
      p.multipath = 0.12;
      p.metal_multipath = 0.2;
      p.outlier_share = 0;
      break;
  }
  return p;
}

}  // namespace binpick::simulation
