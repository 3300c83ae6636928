// A TOML text as plain values with the place where each stands, so that everything else can be
// checked, and complained about, without the parser. Set-up only; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace binpick::app {

// One complaint about a configuration file. line and column count from 1; 0: the file as a whole.
struct ConfigFault {
  std::string file;
  int line = 0, column = 0;
  std::string message;

  // "file:line:column: message"
  std::string text() const;
};

struct TomlValue {
  enum class Type { kFlag, kInteger, kNumber, kText, kList, kOther };
  Type type = Type::kOther;
  bool flag = false;
  std::int64_t integer = 0;
  double number = 0;  // of an integer too
  std::string text;
  std::vector<TomlValue> items;
  int line = 0, column = 0;
};

// What is written there, for people: "text", "a list", ...
const char* type_name(TomlValue::Type type);

// By dotted path ("station.deadline_ms"), in the order of the alphabet. Empty tables leave nothing.
using TomlValues = std::map<std::string, TomlValue>;

// A text that is no TOML gives one fault and no values.
TomlValues parse_toml(std::string_view text, const std::string& file,
                      std::vector<ConfigFault>& faults);

}  // namespace binpick::app
