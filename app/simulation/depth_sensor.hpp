// An active stereo sensor: the gray camera is its left eye, a second eye stands to the right, and a
// projector between them gives the surfaces a pattern. Depth comes from windows that are matched
// between the eyes, with the faults that this brings.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/scene.hpp"
#include "simulation/shading.hpp"

namespace binpick::simulation {

struct DepthSensorParams {
  double baseline_mm = 110;
  double disparity_step_px = 1.0 / 32;
  double noise_px = 0.07;        // of the disparity, from pixel to pixel
  double drift_px = 0.07;        // of the disparity, over patches of some ten pixels
  double fattening_px = 2.2;     // how far the nearer surface spreads over an edge, at most
  double window_mm = 2.0;        // surfaces this close in depth are smoothed together
  double grazing_cos_min = 0.1;  // cosine to the line of sight below which nothing is measured
  double grazing_cos_sure = 0.3;
  double glare_level = 1.15;  // radiance times exposure that blinds the eyes
  double outlier_share = 0.0025;
  double unit_mm = 0.1;  // of the values returned
};

// What the left eye sees without any fault, one entry per pixel.
struct TrueView {
  std::vector<float> z_mm;    // 0 where nothing is
  std::vector<float> facing;  // cosine between the surface's normal and the line of sight
  std::vector<int> body;      // index into Scene::bodies, -1 where nothing is
};

TrueView make_true_view(const Scene& scene, const View& view);

// Depth along the optical axis in units of unit_mm, 0 where there is no measurement. Only pixels in
// the window are measured.
std::vector<std::uint16_t> sense_depth(const Scene& scene, const View& view, const TrueView& truth,
                                       const Radiance& radiance, float exposure, const Roi& window,
                                       const DepthSensorParams& params, Rng rng);

}  // namespace binpick::simulation
