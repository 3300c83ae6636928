// Files that tests of inputs write, and what reading them says.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "binpick/drivers/loaded_frame.hpp"
#include "temporary_folder.hpp"

namespace binpick::drivers {

inline void write_text(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const DatasetError& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace binpick::drivers
