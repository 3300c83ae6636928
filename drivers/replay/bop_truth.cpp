#include "binpick/drivers/bop_truth.hpp"

#include <filesystem>

#include "replay/json_file.hpp"

namespace fs = std::filesystem;

namespace binpick::drivers {
namespace {

// `visible` of each instance of each image.
std::map<int, std::vector<double>> load_visible_fractions(const std::string& path) {
  const nlohmann::json json = read_json_file(path);
  std::map<int, std::vector<double>> visible;
  for (const auto& [key, image] : JsonNode(json, path).members()) {
    std::vector<double>& fractions = visible[id_from_key(key, image)];
    for (const JsonNode& n : image.elements()) fractions.push_back(n.at("visib_fract").number());
  }
  return visible;
}

}  // namespace

std::map<int, std::vector<TruthInstance>> load_truth(const BopDataset& dataset, int scene_id) {
  const std::string path = dataset.scene_file(scene_id, "scene_gt");
  const std::string info_path = dataset.scene_file(scene_id, "scene_gt_info");
  std::map<int, std::vector<TruthInstance>> truth;
  if (!fs::exists(path)) return truth;

  const nlohmann::json json = read_json_file(path);
  for (const auto& [key, image] : JsonNode(json, path).members()) {
    std::vector<TruthInstance>& instances = truth[id_from_key(key, image)];
    for (const JsonNode& n : image.elements()) {
      const Pose pose{n.at("cam_R_m2c").matrix3(), n.at("cam_t_m2c").vector3()};
      instances.push_back({n.at("obj_id").integer(), pose, 1.0});
    }
  }
  if (!fs::exists(info_path)) return truth;

  const auto visible = load_visible_fractions(info_path);
  for (auto& [im_id, instances] : truth) {
    const auto it = visible.find(im_id);
    if (it == visible.end() || it->second.size() != instances.size()) {
      throw DatasetError(info_path + ": image " + std::to_string(im_id) +
                         " does not have as many instances as in scene_gt.json");
    }
    for (std::size_t i = 0; i < instances.size(); ++i)
      instances[i].visible_fraction = it->second[i];
  }
  return truth;
}

std::optional<std::map<FrameId, std::set<int>>> load_targets(const BopDataset& dataset) {
  for (const char* name : {"test_targets_bop19.json", "test_targets_bop24.json"}) {
    const std::string path = (fs::path(dataset.root()) / name).string();
    if (!fs::exists(path)) continue;
    const nlohmann::json json = read_json_file(path);
    std::map<FrameId, std::set<int>> targets;
    for (const JsonNode& n : JsonNode(json, path).elements()) {
      std::set<int>& objects = targets[{n.at("scene_id").integer(), n.at("im_id").integer()}];
      if (const auto obj_id = n.find("obj_id")) objects.insert(obj_id->integer());
    }
    return targets;
  }
  return std::nullopt;
}

}  // namespace binpick::drivers
