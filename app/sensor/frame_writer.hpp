// Writes frames as a data set in the BOP layout: OUT/test/000001/{depth,gray}/NNNNNN.png and
// scene_camera.json. So every capture can be replayed, evaluated and shown by a simulated sensor.
// Thread: one at a time. Faults are SetupError.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "binpick/frame/frame.hpp"

namespace binpick::app {

class FrameWriter {
 public:
  // Refuses a folder that exists and is not empty. `depth_scale`: mm per unit of the depth images.
  FrameWriter(const std::string& folder, double depth_scale);

  void write(const Frame& frame);
  // Makes what was written a whole data set; to be called last.
  void finish();
  int frame_count() const { return count_; }

 private:
  std::filesystem::path scene_;
  double depth_scale_;
  int count_ = 0;
  nlohmann::ordered_json cameras_ = nlohmann::ordered_json::object();
};

}  // namespace binpick::app
