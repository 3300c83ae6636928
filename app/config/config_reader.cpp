#include "config/config_reader.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace binpick::app {
namespace {

constexpr double kLargest = 1e6;  // of a number without a unit, and so without a range of its own

std::string shown(double number) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", number);
  return text;
}

template <class T>
std::string range_text(Range<T> range) {
  return shown(static_cast<double>(range.min)) + " to " + shown(static_cast<double>(range.max));
}

// "_ms", "_mm", ...: what follows the last underscore of a key, as a person reads it.
std::string unit_of(const std::string& path) {
  for (const char* unit : {"ms", "us", "mm", "deg", "px", "hz", "bytes", "mib", "kib"}) {
    if (path.ends_with(std::string("_") + unit)) return std::string(" in ") + unit;
  }
  return "";
}

std::string stem_of(const std::string& path) {
  const std::size_t underscore = path.rfind('_');
  const std::size_t dot = path.rfind('.');
  if (underscore == std::string::npos || (dot != std::string::npos && underscore < dot))
    return path;
  return path.substr(0, underscore);
}

// Levenshtein's distance.
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t kept = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({kept, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

ConfigReader::ConfigReader(std::string_view text, const std::string& file,
                           std::vector<ConfigFault>& faults)
    : file_(file), faults_(faults) {
  const std::size_t before = faults.size();
  values_ = parse_toml(text, file, faults);
  parsed_ = faults.size() == before;
}

void ConfigReader::fault(const std::string& path, const std::string& message) {
  const auto found = values_.find(path);
  const int line = found == values_.end() ? 0 : found->second.line;
  const int column = found == values_.end() ? 0 : found->second.column;
  faults_.push_back({file_, line, column, path + ": " + message});
}

const TomlValue* ConfigReader::take(const Key& key) {
  known_.insert(key.path);
  const auto found = values_.find(key.path);
  return found == values_.end() ? nullptr : &found->second;
}

void ConfigReader::expect(const std::string& path, const TomlValue& value,
                          const std::string& wanted) {
  fault(path, std::string(type_name(value.type)) + " stands where " + wanted + " is expected");
}

bool ConfigReader::read_integer(const std::string& path, const TomlValue& value, Range<int> range,
                                int& out) {
  if (value.type != TomlValue::Type::kInteger) {
    expect(path, value, "a whole number" + unit_of(path));
    return false;
  }
  if (value.integer < range.min || value.integer > range.max) {
    fault(path,
          std::to_string(value.integer) + " is outside of " + range_text(range) + unit_of(path));
    return false;
  }
  out = static_cast<int>(value.integer);
  return true;
}

bool ConfigReader::read_number(const std::string& path, const TomlValue& value, Range<double> range,
                               double& out) {
  if (value.type != TomlValue::Type::kInteger && value.type != TomlValue::Type::kNumber) {
    expect(path, value, "a number" + unit_of(path));
    return false;
  }
  if (!(value.number >= range.min && value.number <= range.max)) {  // NaN too
    fault(path, shown(value.number) + " is outside of " + range_text(range) + unit_of(path));
    return false;
  }
  out = value.number;
  return true;
}

void ConfigReader::flag(const Key& key, bool& value) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  if (written->type != TomlValue::Type::kFlag) return expect(key.path, *written, "true or false");
  value = written->flag;
}

void ConfigReader::integer(const Key& key, int& value, Range<int> range) {
  if (const TomlValue* written = take(key)) read_integer(key.path, *written, range, value);
}

void ConfigReader::number(const Key& key, double& value, Range<double> range) {
  if (const TomlValue* written = take(key)) read_number(key.path, *written, range, value);
}

void ConfigReader::text(const Key& key, std::string& value) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  if (written->type != TomlValue::Type::kText) return expect(key.path, *written, "text");
  if (written->text.find('\0') != std::string::npos)
    return fault(key.path, "a text with a zero byte in it");
  value = written->text;
}

void ConfigReader::choice(const Key& key, int& value, std::span<const char* const> names) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  std::string list;
  for (const char* name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  if (written->type != TomlValue::Type::kText) return expect(key.path, *written, "one of " + list);
  const auto found = std::find(names.begin(), names.end(), written->text);
  if (found == names.end()) return fault(key.path, "'" + written->text + "' is none of " + list);
  value = static_cast<int>(found - names.begin());
}

void ConfigReader::numbers(const Key& key, std::span<double> values, Range<double> range) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  const std::string wanted =
      "a list of " + std::to_string(values.size()) + " numbers" + unit_of(key.path);
  if (written->type != TomlValue::Type::kList) return expect(key.path, *written, wanted);
  if (written->items.size() != values.size()) {
    return fault(key.path, "a list of " + std::to_string(written->items.size()) + " stands where " +
                               wanted + " is expected");
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    read_number(key.path, written->items[i], range, values[i]);
}

void ConfigReader::integers(const Key& key, std::vector<int>& values, Range<int> range) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  if (written->type != TomlValue::Type::kList)
    return expect(key.path, *written, "a list of whole numbers");
  values.clear();
  for (const TomlValue& item : written->items) {
    int value = 0;
    if (read_integer(key.path, item, range, value)) values.push_back(value);
  }
}

// Appends the numbers.
bool ConfigReader::read_row(const std::string& path, const TomlValue& row, std::size_t columns,
                            std::vector<double>& values) {
  if (row.type != TomlValue::Type::kList || row.items.size() != columns) {
    expect(path, row, "a list of " + std::to_string(columns) + " numbers");
    return false;
  }
  for (const TomlValue& item : row.items) {
    if (!read_number(path, item, {-kLargest, kLargest}, values.emplace_back())) return false;
  }
  return true;
}

void ConfigReader::matrix(const Key& key, std::vector<double>& values, std::size_t rows,
                          std::size_t columns) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  values.clear();
  if (written->type == TomlValue::Type::kList && written->items.empty()) return;
  std::vector<double> read;
  if (rows == 1) {
    if (read_row(key.path, *written, columns, read)) values = read;
    return;
  }
  if (written->type != TomlValue::Type::kList || written->items.size() != rows) {
    return expect(
        key.path, *written,
        "a list of " + std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers");
  }
  for (const TomlValue& row : written->items) {
    if (!read_row(key.path, row, columns, read)) return;
  }
  values = read;
}

void ConfigReader::texts(const Key& key, std::vector<std::string>& values) {
  const TomlValue* written = take(key);
  if (written == nullptr) return;
  if (written->type != TomlValue::Type::kList) return expect(key.path, *written, "a list of texts");
  values.clear();
  for (const TomlValue& item : written->items) {
    if (item.type != TomlValue::Type::kText) {
      expect(key.path, item, "a text");
    } else if (item.text.find('\0') != std::string::npos) {
      fault(key.path, "a text with a zero byte in it");
    } else {
      values.push_back(item.text);
    }
  }
}

std::string ConfigReader::hint(const std::string& unknown) const {
  for (const std::string& key : known_) {
    if (stem_of(key) == stem_of(unknown)) {
      return ": the key is " + key + (unit_of(key).empty() ? "" : "," + unit_of(key));
    }
  }
  for (const std::string& key : known_) {
    if (edits_between(key, unknown) <= 2) return ": is " + key + " meant?";
  }
  return "";
}

void ConfigReader::finish() {
  for (const auto& [path, value] : values_) {
    if (!known_.contains(path)) fault(path, "there is no such key" + hint(path));
  }
}

}  // namespace binpick::app
