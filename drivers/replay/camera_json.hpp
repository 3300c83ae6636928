// What an entry of scene_camera.json or a camera file says, whoever wrote it: see camera_keys.hpp.
#pragma once

#include <string>
#include <vector>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/json_file.hpp"

namespace binpick::drivers {

// An object that holds a camera's focal lengths or matrix, below the objects that hold it. What is
// not of the lens itself, as the image's size, may stand in any of them.
struct CameraNode {
  std::string name;            // keys from the root, joined by '.'; empty: the root itself
  std::vector<JsonNode> path;  // the camera first, the root last
};

// The root alone when it is a camera itself; else those within it.
std::vector<CameraNode> find_cameras(const JsonNode& root);

// The value of the first of these keys (plain, see camera_keys.hpp) in the camera's own object.
std::optional<JsonNode> own_value(const CameraNode& camera,
                                  std::initializer_list<const char*> keys);
// The same, in the camera's object or else in the nearest one around it.
std::optional<JsonNode> value(const CameraNode& camera, std::initializer_list<const char*> keys);

// The numbers of a list, of a list of lists, or of {rows, cols, data}.
std::vector<double> flat_numbers(const JsonNode& node);

// Throws DatasetError where anything that is needed is missing, or cannot be a pinhole camera.
FrameCamera camera_from_json(const CameraNode& camera);

}  // namespace binpick::drivers
