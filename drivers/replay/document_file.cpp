#include "replay/document_file.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/file_kind.hpp"

namespace binpick::drivers {
namespace {

using nlohmann::json;

// A page of numbers is a few kB; an image or a recording given by mistake is not read to its end.
constexpr std::uintmax_t kBytesMax = 16u << 20;
constexpr int kNodesMax = 1000000;  // aliases of aliases would fill the memory

std::string read_text(const std::string& path) {
  const FileKind kind = kind_of_file(path);
  if (kind.format != FileFormat::kUnknown)
    throw DatasetError(path + ": is " + kind.name + ", not a camera file");
  std::error_code error;
  if (std::filesystem::file_size(path, error) > kBytesMax)
    throw DatasetError(path + ": is larger than 16 MB: it is no camera file");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// 1., .5, +3 and 1e-3 too, which YAML's writers use and JSON does not know.
json scalar_from_yaml(const YAML::Node& node) {
  std::string text = node.Scalar();
  if (node.Tag() == "!") return text;  // in quotes
  if (text == "true" || text == "false") return text == "true";
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  double number = 0;
  const auto [stop, error] = std::from_chars(begin, end, number);
  if (error == std::errc() && stop == end) return number;
  if (text == ".nan" || text == ".NaN" || text == ".inf" || text == "-.inf")
    return std::numeric_limits<double>::quiet_NaN();
  return text;
}

json json_from_yaml(const YAML::Node& node, int& nodes_left) {
  if (--nodes_left < 0) throw YAML::Exception(node.Mark(), "there is too much in it");
  if (node.IsScalar()) return scalar_from_yaml(node);
  if (node.IsSequence()) {
    json list = json::array();
    for (const YAML::Node& element : node) list.push_back(json_from_yaml(element, nodes_left));
    return list;
  }
  if (!node.IsMap()) return nullptr;
  json object = json::object();
  for (const auto& member : node) {
    if (!member.first.IsScalar()) throw YAML::Exception(member.first.Mark(), "a key is no text");
    object[member.first.Scalar()] = json_from_yaml(member.second, nodes_left);
  }
  return object;
}

json read_yaml(const std::string& path, std::string text) {
  // OpenCV writes %YAML:1.0, with a colon, and older versions no end of directives after it.
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  try {
    int nodes_left = kNodesMax;
    return json_from_yaml(YAML::Load(text), nodes_left);
  } catch (const YAML::Exception& e) {
    const std::string line =
        e.mark.is_null() ? "" : "line " + std::to_string(e.mark.line + 1) + ": ";
    throw DatasetError(path + ": " + line + "is not valid YAML (" + e.msg + ")");
  }
}

json json_from_opencv(const cv::FileNode& node) {
  if (node.isInt()) return static_cast<int>(node);
  if (node.isReal()) return static_cast<double>(node);
  if (node.isString()) return static_cast<std::string>(node);
  json list = json::array(), object = json::object();
  for (const cv::FileNode& child : node) {
    if (node.isMap())
      object[child.name()] = json_from_opencv(child);
    else
      list.push_back(json_from_opencv(child));
  }
  return node.isMap() ? object : list;
}

json read_xml(const std::string& path, const std::string& text) {
  try {
    const cv::FileStorage storage(
        text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_XML);
    return json_from_opencv(storage.root());
  } catch (const cv::Exception& e) {
    throw DatasetError(path + ": is not XML as OpenCV's FileStorage writes it (" + e.err + ")");
  }
}

json read_json(const std::string& path, const std::string& text) {
  try {
    return json::parse(text);
  } catch (const json::exception& e) {
    throw DatasetError(path + ": is not valid JSON (" + e.what() + ")");
  }
}

}  // namespace

json read_document(const std::string& path) {
  std::string text = read_text(path);
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw DatasetError(path + ": is empty");
  if (ending == ".yml" || ending == ".yaml") return read_yaml(path, std::move(text));
  if (ending == ".json" || text[first] == '{' || text[first] == '[') return read_json(path, text);
  if (text[first] == '<') return read_xml(path, text);
  return read_yaml(path, std::move(text));
}

}  // namespace binpick::drivers
