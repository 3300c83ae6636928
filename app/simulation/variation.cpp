#include "simulation/variation.hpp"

#include <cmath>

namespace binpick::simulation {
namespace {

constexpr double kNoiseMin = 0.5, kNoiseMax = 3;
constexpr double kScaleOff = 0.005, kBendMax = 0.004;
constexpr std::array kFinishes = {Finish::kCastBrass, Finish::kGalvanised, Finish::kMachined,
                                  Finish::kPolished,  Finish::kPlastic,    Finish::kRubber};

}  // namespace

FrameSetting varied_setting(const CameraParams& camera, SensorKind kind, Rng& rng) {
  FrameSetting setting;
  setting.camera = camera;
  setting.sensor = sensor_params(kind);
  const double noise = std::exp(rng.uniform(std::log(kNoiseMin), std::log(kNoiseMax)));
  setting.sensor.noise_px *= noise;
  setting.sensor.drift_px *= noise;
  setting.sensor.glare_level *= rng.uniform(0.7, 1.3);
  setting.as_made.finish = kFinishes[static_cast<std::size_t>(rng.below(kFinishes.size()))];
  setting.as_made.scale = 1 + rng.uniform(-kScaleOff, kScaleOff);
  setting.as_made.bend = rng.uniform(-kBendMax, kBendMax);
  return setting;
}

}  // namespace binpick::simulation
