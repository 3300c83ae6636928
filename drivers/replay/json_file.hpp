// JSON files from outside, read with complaints that a person can act on: each JsonNode knows the
// file and the path of keys that led to it, and throws DatasetError with both.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "binpick/geometry/pose.hpp"

namespace binpick::drivers {

nlohmann::json read_json_file(const std::string& path);

// Borrows the value.
class JsonNode {
 public:
  // `where` starts as the file's name.
  JsonNode(const nlohmann::json& value, std::string where)
      : value_(&value), where_(std::move(where)) {}

  JsonNode at(const std::string& key) const;
  std::optional<JsonNode> find(const std::string& key) const;
  // The members of an object, or the elements of an array.
  std::vector<std::pair<std::string, JsonNode>> members() const;
  std::vector<JsonNode> elements() const;

  bool is_object() const { return value_->is_object(); }
  bool is_list() const { return value_->is_array(); }
  bool is_number() const { return value_->is_number(); }
  bool is_null() const { return value_->is_null(); }

  double number() const;  // finite
  int integer() const;
  std::vector<double> numbers(std::size_t count) const;
  Vec3 vector3() const;
  Mat3 matrix3() const;  // nine numbers, row-major
  std::string text() const;

  [[noreturn]] void fail(const std::string& complaint) const;

 private:
  const nlohmann::json* value_;
  std::string where_;
};

// The id that a BOP file uses as an object key; fails on anything but a whole number.
int id_from_key(const std::string& key, const JsonNode& node);

}  // namespace binpick::drivers
