#include "config/toml_file.hpp"

// The parser is large: this file and the sensor profiles' reader alone include it, alike.
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

namespace binpick::app {
namespace {

TomlValue value_of(const toml::node& node) {
  TomlValue value;
  value.line = static_cast<int>(node.source().begin.line);
  value.column = static_cast<int>(node.source().begin.column);
  if (const auto* flag = node.as_boolean()) {
    value.type = TomlValue::Type::kFlag;
    value.flag = flag->get();
  } else if (const auto* integer = node.as_integer()) {
    value.type = TomlValue::Type::kInteger;
    value.integer = integer->get();
    value.number = static_cast<double>(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    value.type = TomlValue::Type::kNumber;
    value.number = number->get();
  } else if (const auto* text = node.as_string()) {
    value.type = TomlValue::Type::kText;
    value.text = text->get();
  } else if (const auto* list = node.as_array()) {
    value.type = TomlValue::Type::kList;
    for (const toml::node& item : *list) value.items.push_back(value_of(item));
  }
  return value;
}

void flatten(const toml::table& table, const std::string& prefix, TomlValues& values) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    if (const auto* inner = node.as_table()) {
      flatten(*inner, path + ".", values);
      continue;
    }
    TomlValue value = value_of(node);
    // Where the line begins, rather than behind the equals sign.
    value.line = static_cast<int>(key.source().begin.line);
    value.column = static_cast<int>(key.source().begin.column);
    values.insert_or_assign(path, std::move(value));
  }
}

}  // namespace

std::string ConfigFault::text() const {
  std::string place = file;
  if (line > 0) place += ":" + std::to_string(line) + ":" + std::to_string(column);
  return place + ": " + message;
}

const char* type_name(TomlValue::Type type) {
  switch (type) {
    case TomlValue::Type::kFlag:
      return "true or false";
    case TomlValue::Type::kInteger:
      return "a whole number";
    case TomlValue::Type::kNumber:
      return "a number";
    case TomlValue::Type::kText:
      return "text";
    case TomlValue::Type::kList:
      return "a list";
    case TomlValue::Type::kOther:
      break;
  }
  return "a date, a time or a table";
}

TomlValues parse_toml(std::string_view text, const std::string& file,
                      std::vector<ConfigFault>& faults) {
  TomlValues values;
  const toml::parse_result result = toml::parse(text);
  if (!result) {
    const toml::parse_error& error = result.error();
    const toml::source_position at = error.source().begin;
    faults.push_back({file, static_cast<int>(at.line), static_cast<int>(at.column),
                      std::string(error.description())});
    return values;
  }
  flatten(result.table(), "", values);
  return values;
}

}  // namespace binpick::app
