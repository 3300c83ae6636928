#include <filesystem>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/camera_json.hpp"
#include "replay/camera_keys.hpp"
#include "replay/document_file.hpp"

namespace binpick::drivers {
namespace {

struct NamedFile {
  std::string path, camera;
};

// FILE or FILE#CAMERA; '#' may be part of a file's own name.
NamedFile split_name(const std::string& path) {
  std::error_code error;
  const std::size_t mark = path.rfind('#');
  if (mark == std::string::npos || std::filesystem::exists(path, error)) return {path, ""};
  return {path.substr(0, mark), path.substr(mark + 1)};
}

bool is_named(const CameraNode& camera, const std::string& name) {
  return camera.name == name || camera.name.ends_with("." + name);
}

CameraNode choose_camera(std::vector<CameraNode> cameras, const NamedFile& file) {
  std::string names;
  for (const CameraNode& camera : cameras)
    names += (names.empty() ? "" : ", ") + (camera.name.empty() ? "one without name" : camera.name);
  if (file.camera.empty()) {
    if (cameras.size() == 1) return cameras.front();
    throw DatasetError(file.path + ": holds several cameras: " + names +
                       "; choose one: " + file.path + "#" + cameras.front().name);
  }
  std::erase_if(cameras, [&](const CameraNode& c) { return !is_named(c, file.camera); });
  if (cameras.size() == 1) return cameras.front();
  throw DatasetError(file.path + ": '" + file.camera + "' names " +
                     (cameras.empty() ? "none" : "more than one") + " of its cameras: " + names);
}

std::vector<std::string> unknown_keys(const CameraNode& camera, const std::string& path) {
  std::vector<std::string> notes;
  for (const auto& [key, node] : camera.path.front().members()) {
    const std::string plain = plain_key(key);
    if (is_known_camera_key(plain)) continue;
    const std::string nearest = nearest_camera_key(plain);
    notes.push_back("warning: " + path + ": unknown key \"" + key + "\" is ignored" +
                    (nearest.empty() ? "" : "; was \"" + nearest + "\" meant?"));
  }
  return notes;
}

}  // namespace

FrameCamera load_camera_file(const std::string& path) {
  const NamedFile file = split_name(path);
  const nlohmann::json document = read_document(file.path);
  const CameraNode chosen = choose_camera(find_cameras(JsonNode(document, file.path)), file);
  FrameCamera camera = camera_from_json(chosen);
  camera.notes = unknown_keys(chosen, file.path);
  return camera;
}

FrameCamera load_sensor_camera_file(const std::string& path) {
  FrameCamera camera = load_camera_file(path);
  if (camera.lens.none()) return camera;
  throw DatasetError(path +
                     ": has lens distortion, which is not removed from a live sensor's images: let "
                     "the sensor rectify them, and give the intrinsics of the rectified images "
                     "with distortion coefficients of 0");
}

}  // namespace binpick::drivers
