// Files that hold named values, whatever their syntax: JSON, YAML, and the XML of OpenCV's
// FileStorage. Throws DatasetError that names the file and, where the parser tells it, the line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace binpick::drivers {

// The syntax follows the name's ending, else the first character. Of several YAML documents in a
// file the first.
nlohmann::json read_document(const std::string& path);

}  // namespace binpick::drivers
