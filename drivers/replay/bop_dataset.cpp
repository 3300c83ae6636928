#include "binpick/drivers/bop_dataset.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string_view>

#include "replay/camera_json.hpp"

namespace fs = std::filesystem;

namespace binpick::drivers {
namespace {

std::string six_digits(int id) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", id);
  return text;
}

// The image `id` in `folder`, whatever its format. Throws when there is none.
std::string image_path(const fs::path& folder, int id) {
  const fs::path stem = folder / six_digits(id);
  for (const char* extension : {".png", ".tif", ".tiff", ".jpg", ".jpeg"}) {
    const fs::path path = stem.string() + extension;
    std::error_code error;
    if (fs::is_regular_file(path, error)) return path.string();
  }
  throw DatasetError(stem.string() + ".*: there is no such PNG, TIFF or JPEG file");
}

bool has_folder(const std::string& scene_path, const std::string& name) {
  std::error_code error;
  return fs::is_directory(fs::path(scene_path) / name, error);
}

// SENSOR of each scene_camera_SENSOR.json; "" of scene_camera.json.
std::set<std::string> sensors_of(const std::string& scene_path) {
  constexpr std::string_view kStem = "scene_camera";
  std::set<std::string> sensors;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(scene_path, error)) {
    const fs::path name = entry.path().filename();
    const std::string stem = name.stem().string();
    if (name.extension() != ".json" || !stem.starts_with(kStem)) continue;
    const std::string rest = stem.substr(kStem.size());
    if (rest.empty()) sensors.insert("");
    if (rest.starts_with("_")) sensors.insert(rest.substr(1));
  }
  return sensors;
}

Pose symmetry_from_json(const JsonNode& node) {
  const std::vector<double> v = node.numbers(16);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> M(v.data());
  const Pose symmetry{M.block<3, 3>(0, 0), M.block<3, 1>(0, 3)};
  const Mat3 error = symmetry.R * symmetry.R.transpose() - Mat3::Identity();
  if (error.cwiseAbs().maxCoeff() > 1e-3 || symmetry.R.determinant() < 0)
    node.fail("is not a rotation");
  return symmetry;
}

BopModel model_from_json(const JsonNode& node) {
  BopModel model;
  model.diameter_mm = node.at("diameter").number();
  if (model.diameter_mm <= 0) node.at("diameter").fail("is not positive");
  if (const auto list = node.find("symmetries_discrete")) {
    for (const JsonNode& n : list->elements())
      model.symmetries_discrete.push_back(symmetry_from_json(n));
  }
  if (const auto list = node.find("symmetries_continuous")) {
    for (const JsonNode& n : list->elements()) {
      ContinuousSymmetry symmetry;
      symmetry.axis = n.at("axis").vector3();
      if (symmetry.axis.norm() < 1e-9) n.at("axis").fail("has no length");
      symmetry.axis.normalize();
      if (const auto offset = n.find("offset")) symmetry.offset_mm = offset->vector3();
      model.symmetries_continuous.push_back(symmetry);
    }
  }
  return model;
}

}  // namespace

std::string frame_name(FrameId id) {
  return six_digits(id.scene_id) + "/" + six_digits(id.im_id);
}

BopDataset::BopDataset(const std::string& root, const std::string& split, const std::string& sensor)
    : root_(root), split_path_((fs::path(root) / split).string()) {
  std::error_code error;
  if (!fs::is_directory(root_, error)) throw DatasetError(root_ + ": there is no such folder");
  if (!fs::is_directory(split_path_, error)) {
    throw DatasetError(split_path_ +
                       ": there is no such folder; a BOP data set keeps its scenes there");
  }
  fs::directory_iterator entries(split_path_, error);
  if (error) throw DatasetError(split_path_ + ": cannot be listed (" + error.message() + ")");
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    const bool digits =
        std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!entry.is_directory(error) || !digits || name.size() > 9) continue;
    scene_paths_[std::stoi(name)] = entry.path().string();
  }
  for (const auto& [id, path] : scene_paths_) scene_ids_.push_back(id);
  if (scene_ids_.empty())
    throw DatasetError(split_path_ + ": holds no scene (a folder named by a number)");
  choose_sensor(sensor);
}

void BopDataset::choose_sensor(const std::string& sensor) {
  std::set<std::string> found;
  for (const auto& [id, path] : scene_paths_) found.merge(sensors_of(path));
  if (!sensor.empty()) suffix_ = "_" + sensor;
  if (found.contains(sensor) || (sensor.empty() && found.empty())) return;
  found.erase("");
  std::string names;
  for (const std::string& name : found) names += (names.empty() ? "" : ", ") + name;
  if (sensor.empty())
    throw DatasetError(split_path_ + ": has frames of several sensors: " + names +
                       "; choose one with --sensor");
  throw DatasetError(split_path_ + ": has no sensor '" + sensor + "'" +
                     (names.empty()
                          ? ": its scenes have scene_camera.json alone, leave --sensor out"
                          : "; there are " + names));
}

// The whole set's, where its frames have none of their own.
std::optional<double> BopDataset::common_depth_scale() const {
  for (const std::string& name : {"camera" + suffix_ + ".json", std::string("camera.json")}) {
    const std::string path = (fs::path(root_) / name).string();
    std::error_code error;
    if (!fs::is_regular_file(path, error)) continue;
    const nlohmann::json json = read_json_file(path);
    const auto scale = JsonNode(json, path).find("depth_scale");
    if (scale && scale->number() <= 0) scale->fail("is not positive");
    if (scale) return scale->number();
  }
  return std::nullopt;
}

std::string BopDataset::scene_path(int scene_id) const {
  const auto it = scene_paths_.find(scene_id);
  if (it == scene_paths_.end()) {
    throw DatasetError(split_path_ + ": has no scene " + std::to_string(scene_id));
  }
  return it->second;
}

std::string BopDataset::scene_file(int scene_id, const std::string& stem) const {
  return (fs::path(scene_path(scene_id)) / (stem + suffix_ + ".json")).string();
}

BopScene BopDataset::scene(int scene_id) const {
  BopScene scene{scene_id, scene_path(scene_id), {}};
  const std::string path = scene_file(scene_id, "scene_camera");
  const nlohmann::json json = read_json_file(path);
  const bool has_depth = has_folder(scene.path, "depth" + suffix_);
  const std::optional<double> common = has_depth ? common_depth_scale() : std::nullopt;
  for (const auto& [key, node] : JsonNode(json, path).members()) {
    FrameCamera camera = camera_from_json(CameraNode{"", {node}});
    if (!camera.depth_scale) camera.depth_scale = common;
    if (!camera.depth_scale && has_depth)
      node.fail("has no key \"depth_scale\", and neither has camera.json of the data set");
    scene.frames[id_from_key(key, node)] = camera;
  }
  return scene;
}

LoadedFrame BopDataset::load_frame(const BopScene& scene, int im_id) const {
  const auto it = scene.frames.find(im_id);
  const fs::path folder = scene.path;
  if (it == scene.frames.end()) {
    throw DatasetError(scene_file(scene.scene_id, "scene_camera") + ": has no entry for image " +
                       std::to_string(im_id));
  }
  // A sensor without depth or without intensity has no such folder; a folder without the image is a
  // fault, and so is a scene without any.
  std::string depth, intensity;
  for (const std::string& name : {"rgb" + suffix_, "gray" + suffix_}) {
    if (has_folder(scene.path, name)) intensity = image_path(folder / name, im_id);
  }
  if (intensity.empty() || has_folder(scene.path, "depth" + suffix_))
    depth = image_path(folder / ("depth" + suffix_), im_id);
  // Here the unit is part of the format, of floats too.
  return load_frame_files(depth, intensity, it->second, it->second.depth_scale);
}

std::map<int, BopModel> BopDataset::models() const {
  const fs::path folder = fs::path(root_) / "models";
  const std::string path = (folder / "models_info.json").string();
  const nlohmann::json json = read_json_file(path);
  std::map<int, BopModel> models;
  for (const auto& [key, node] : JsonNode(json, path).members()) {
    BopModel model = model_from_json(node);
    model.obj_id = id_from_key(key, node);
    model.mesh_path = (folder / ("obj_" + six_digits(model.obj_id) + ".ply")).string();
    models[model.obj_id] = std::move(model);
  }
  return models;
}

}  // namespace binpick::drivers
