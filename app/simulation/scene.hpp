// The world of one frame: bench, bin, parts, and the camera that looks at them. World coordinates
// are the bin's: origin in the middle of the floor, z upwards, mm.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/part.hpp"
#include "simulation/pile.hpp"
#include "simulation/rasteriser.hpp"

namespace binpick::simulation {

// What a triangle of the soup belongs to, and what its surface looks like.
struct Body {
  Finish finish = Finish::kBench;
  Pose T_world_obj;
  std::uint32_t seed = 0;   // of its texture
  float brightness = 1;     // no two castings are quite alike
  int part = -1;            // index into Scene::parts, or -1 for bench and bin
  int first = 0, last = 0;  // its triangles
};

struct Scene {
  BinSize bin;
  std::vector<PlacedPart> parts;  // kind is an index into the data set's parts
  std::vector<Body> bodies;
  TriangleSoup soup;
};

// How parts as they are made differ from their CAD.
struct PartsAsMade {
  std::optional<Finish> finish;  // instead of the part's
  double scale = 1;
  double bend = 0;  // by how much the ends of the longest side leave the line, as a share of it
};

struct CameraParams {
  int width = 1280;
  int height = 1024;
  double fx = 1908.6, fy = 1907.9, cx = 633.2, cy = 518.4;
  double bin_length_px = 700;  // about; fixes the distance, unless that is given
  double distance_mm = 0;      // to the middle of the bin's rim; 0: by bin_length_px
  double tilt_max_rad = 0.26;
};

struct Roi {
  int x, y, width, height;
};

Scene make_scene(const std::vector<Part>& kinds, const std::vector<PlacedPart>& placed,
                 const BinSize& bin, const PartsAsMade& as_made, Rng rng);
// Above the bin: turned by a multiple of 90 degrees and a little, tilted, and a little off centre.
View make_camera(const CameraParams& params, const BinSize& bin, Rng rng);
// The upright rectangle about the bin's inside at the height of its rim, clipped to the image.
Roi bin_roi(const View& view, const BinSize& bin, int margin_x, int margin_y);

}  // namespace binpick::simulation
