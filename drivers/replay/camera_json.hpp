// The camera entry that scene_camera.json and single camera files share.
#pragma once

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/json_file.hpp"

namespace binpick::drivers {

FrameCamera camera_from_json(const JsonNode& node);

}  // namespace binpick::drivers
