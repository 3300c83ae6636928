// A data set in the BOP layout: models/ and <split>/<scene>/{depth,gray|rgb}/<image>.* with
// scene_camera.json. Of sets with several sensors one is chosen: its files and folders are
// scene_camera_SENSOR.json, depth_SENSOR/ and so on. This header gives what a sensor and a CAD
// folder would give; the truth is in bop_truth.hpp, so that an include shows who looks at it. Every
// fault is a DatasetError that names the file. Thread-safe: immutable, nothing is cached.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "binpick/drivers/loaded_frame.hpp"
#include "binpick/geometry/pose.hpp"

namespace binpick::drivers {

struct FrameId {
  int scene_id = 0;
  int im_id = 0;
  auto operator<=>(const FrameId&) const = default;
};

// "000001/000003", for messages.
std::string frame_name(FrameId id);

// Rotation by any angle about the line through offset_mm along axis, in object coordinates.
struct ContinuousSymmetry {
  Vec3 axis = Vec3::UnitZ();  // unit length
  Vec3 offset_mm = Vec3::Zero();
};

// An entry of models/models_info.json.
struct BopModel {
  int obj_id = 0;
  std::string mesh_path;
  double diameter_mm = 0;
  std::vector<Pose> symmetries_discrete;  // object to object; the identity is not listed
  std::vector<ContinuousSymmetry> symmetries_continuous;
};

// The frames of one scene: image id to camera.
struct BopScene {
  int scene_id = 0;
  std::string path;
  std::map<int, FrameCamera> frames;
};

class BopDataset {
 public:
  // Throws when there is no such folder, the split holds no scene, or the sensor is none of its;
  // without a name, when there are several sensors. It lists them.
  BopDataset(const std::string& root, const std::string& split, const std::string& sensor = "");

  const std::string& root() const { return root_; }
  const std::vector<int>& scene_ids() const { return scene_ids_; }  // ascending
  std::string scene_path(int scene_id) const;
  // Of the sensor: scene_gt -> SCENE/scene_gt.json, or SCENE/scene_gt_SENSOR.json.
  std::string scene_file(int scene_id, const std::string& stem) const;

  BopScene scene(int scene_id) const;
  LoadedFrame load_frame(const BopScene& scene, int im_id) const;
  // By object id. Needs models/models_info.json; the mesh files are not opened.
  std::map<int, BopModel> models() const;

 private:
  void choose_sensor(const std::string& sensor);
  std::optional<double> common_depth_scale() const;

  std::string root_, split_path_;
  std::string suffix_;  // of the sensor's files and folders: "_SENSOR", or empty
  std::map<int, std::string> scene_paths_;
  std::vector<int> scene_ids_;
};

}  // namespace binpick::drivers
