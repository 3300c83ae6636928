// The keys that camera files use, of BOP, OpenCV, ROS, RealSense, Open3D and ours, and what a
// person may have meant by another one.
#pragma once

#include <string>
#include <string_view>

namespace binpick::drivers {

// Without case, '_' and '-': camera_matrix, cameraMatrix and Camera_Matrix are one key.
std::string plain_key(std::string_view key);

bool is_known_camera_key(std::string_view plain);

// The known key that differs by a typing mistake; empty where there is none.
std::string nearest_camera_key(std::string_view plain);

}  // namespace binpick::drivers
