// A depth sensor whose gray camera is its eye: what it sees of a scene, and what it makes of that.
// One pipeline serves all kinds of sensors; they differ in its numbers (sensor_kind.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/scene.hpp"
#include "simulation/shading.hpp"

namespace binpick::simulation {

// As they are given here, those of active stereo: a second eye stands to the right, and a projector
// between them gives the surfaces a pattern. Depth comes from windows that are matched between the
// eyes.
struct DepthSensorParams {
  double baseline_mm = 110;       // to the second eye, or to the projector of structured light
  bool second_ray = true;         // what that does not see is not measured
  bool shadow_of_pattern = true;  // in the shadow of a projector near the eye little is measured
  double disparity_step_px = 1.0 / 32;
  double noise_px = 0.07;        // of the disparity, from pixel to pixel
  double drift_px = 0.07;        // of the disparity, over patches of some ten pixels
  double plain_factor = 1;       // noise and drift of a surface without texture, times as much
  double fattening_px = 2.2;     // how far the nearer surface spreads over an edge, at most
  double edge_px = 0;            // pixels so near to a depth step are not measured
  int window_px = 2;             // half the width of what is averaged
  double window_mm = 2.0;        // surfaces this close in depth are averaged together
  double grazing_cos_min = 0.1;  // cosine to the line of sight below which nothing is measured
  double grazing_cos_sure = 0.3;
  double glare_level = 1.15;   // radiance times exposure that blinds the sensor
  double dark_level = 0.012;   // and that it needs
  bool by_own_light = false;   // glare and darkness are of the projector's light alone
  double multipath = 0;        // towards nearer surroundings, as a share of how much nearer
  double metal_multipath = 0;  // the same on metal
  double outlier_share = 0.0025;
  int filled_gap_px = 0;  // gaps up to this wide take the depth of their farther side
  double unit_mm = 0.1;   // of the values returned
};

// What the eye sees without any fault, one entry per pixel.
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
