// Writes a data set in the BOP layout.
#pragma once

#include <filesystem>
#include <vector>

#include "simulation/frame_maker.hpp"

namespace binpick::simulation {

// camera.json, the meshes and models_info.json.
void write_models(const std::filesystem::path& root, const std::vector<Part>& parts,
                  const CameraParams& camera);

// One scene, frame by frame; the JSON files are written by finish().
class SceneWriter {
 public:
  SceneWriter(const std::filesystem::path& root, int scene_id);
  void add(const Frame& frame);
  void finish() const;

 private:
  std::filesystem::path folder_;
  std::vector<std::string> camera_lines_, gt_lines_, info_lines_;
};

}  // namespace binpick::simulation
