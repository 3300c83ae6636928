// One frame from a seed: pile, camera, gray image, depth image and the truth about every part.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/depth_sensor.hpp"
#include "simulation/scene.hpp"

namespace binpick::simulation {

struct PixelBox {
  int x = -1, y = -1, width = -1, height = -1;  // all -1 when there is no pixel
};

struct InstanceTruth {
  int obj_id = 0;
  Pose T_cam_obj;
  int px_count_all = 0;    // of the whole silhouette inside the image, as if nothing hid it
  int px_count_visib = 0;  // of what is seen
  int px_count_valid = 0;  // of what is seen and has a depth
  double visib_fract = 0;
  PixelBox bbox_obj, bbox_visib;
};

struct Frame {
  View view;
  Roi roi{};
  std::vector<unsigned char> gray;
  std::vector<std::uint16_t> depth;  // in units of the sensor, 0.1 mm
  std::vector<InstanceTruth> instances;
};

// Who looks at what.
struct FrameSetting {
  CameraParams camera;
  DepthSensorParams sensor;
  PartsAsMade as_made;
};

struct FrameParams {
  FrameSetting setting;  // where make() is given none
  BinSize bin;
  int part_count = 0;           // 0: as many as fill the bin well
  bool gray_everywhere = true;  // false: only where depth is measured, in and about the bin
};

class FrameMaker {
 public:
  // Prepares the collision shapes, which takes some seconds per part.
  FrameMaker(const std::vector<Part>& parts, const FrameParams& params);

  // A pile of the given kinds in about equal numbers; the same seed gives the same frame. Safe to
  // call from several threads at once.
  Frame make(const std::vector<std::size_t>& kinds, std::uint64_t seed) const {
    return make(kinds, seed, params_.setting);
  }
  // The same parts, made otherwise and seen by another camera and sensor.
  Frame make(const std::vector<std::size_t>& kinds, std::uint64_t seed,
             const FrameSetting& setting) const;

 private:
  std::vector<std::size_t> draw_kinds(const std::vector<std::size_t>& kinds, Rng& rng) const;

  const std::vector<Part>& parts_;
  FrameParams params_;
  std::vector<CollisionShape> shapes_;
  std::vector<double> fill_volumes_;  // mm3 of bin that one part takes up in a pile
};

}  // namespace binpick::simulation
