#include "replay/json_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {

nlohmann::json read_json_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DatasetError(path + ": cannot be opened");
  try {
    return nlohmann::json::parse(file);
  } catch (const nlohmann::json::exception& e) {
    throw DatasetError(path + ": is not valid JSON (" + e.what() + ")");
  }
}

void JsonNode::fail(const std::string& complaint) const {
  throw DatasetError(where_ + ": " + complaint);
}

std::optional<JsonNode> JsonNode::find(const std::string& key) const {
  if (!value_->is_object()) fail("is not an object");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return JsonNode(*it, where_ + ": " + key);
}

JsonNode JsonNode::at(const std::string& key) const {
  const std::optional<JsonNode> node = find(key);
  if (!node) fail("has no key \"" + key + "\"");
  return *node;
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  if (!value_->is_object()) fail("is not an object");
  std::vector<std::pair<std::string, JsonNode>> members;
  for (const auto& [key, value] : value_->items()) {
    members.emplace_back(key, JsonNode(value, where_ + ": " + key));
  }
  return members;
}

std::vector<JsonNode> JsonNode::elements() const {
  if (!value_->is_array()) fail("is not a list");
  std::vector<JsonNode> elements;
  for (std::size_t i = 0; i < value_->size(); ++i) {
    elements.emplace_back((*value_)[i], where_ + "[" + std::to_string(i) + "]");
  }
  return elements;
}

double JsonNode::number() const {
  if (!value_->is_number()) fail("is not a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) fail("is not finite");
  return number;
}

int JsonNode::integer() const {
  const double value = number();
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max()) {
    fail("is not a whole number");
  }
  return static_cast<int>(value);
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
  const std::vector<JsonNode> nodes = elements();
  if (nodes.size() != count) {
    fail("has " + std::to_string(nodes.size()) + " numbers where " + std::to_string(count) +
         " are expected");
  }
  std::vector<double> numbers;
  for (const JsonNode& node : nodes) numbers.push_back(node.number());
  return numbers;
}

Vec3 JsonNode::vector3() const {
  const std::vector<double> v = numbers(3);
  return {v[0], v[1], v[2]};
}

Mat3 JsonNode::matrix3() const {
  const std::vector<double> v = numbers(9);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
}

std::string JsonNode::text() const {
  if (!value_->is_string()) fail("is not a text");
  return value_->get<std::string>();
}

int id_from_key(const std::string& key, const JsonNode& node) {
  int id = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), id);
  if (error != std::errc() || end != key.data() + key.size() || id < 0) {
    node.fail("the key is not a number");
  }
  return id;
}

}  // namespace binpick::drivers
