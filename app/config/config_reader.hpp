// Moves values from a TOML text into a configuration, key by key, and collects every fault instead
// of stopping at the first: unknown keys, wrong types, values out of range. Set-up only.
#pragma once

#include <set>

#include "config/config_keys.hpp"
#include "config/toml_file.hpp"

namespace binpick::app {

class ConfigReader final : public KeyVisitor {
 public:
  // `text` is parsed here; `file` is for messages.
  ConfigReader(std::string_view text, const std::string& file, std::vector<ConfigFault>& faults);

  void flag(const Key& key, bool& value) override;
  void integer(const Key& key, int& value, Range<int> range) override;
  void number(const Key& key, double& value, Range<double> range) override;
  void text(const Key& key, std::string& value) override;
  void choice(const Key& key, int& value, std::span<const char* const> names) override;
  void numbers(const Key& key, std::span<double> values, Range<double> range) override;
  void integers(const Key& key, std::vector<int>& values, Range<int> range) override;
  void matrix(const Key& key, std::vector<double>& values, std::size_t rows,
              std::size_t columns) override;
  void texts(const Key& key, std::vector<std::string>& values) override;

  // After the visit: what is left over is unknown.
  void finish();
  // A fault of what was read, at the place of `path`, or of the file where it was not written.
  void fault(const std::string& path, const std::string& message);
  bool wrote(const std::string& path) const { return values_.contains(path); }
  // False where the text was no TOML.
  bool parsed() const { return parsed_; }

 private:
  const TomlValue* take(const Key& key);
  void expect(const std::string& path, const TomlValue& value, const std::string& wanted);
  bool read_integer(const std::string& path, const TomlValue& value, Range<int> range, int& out);
  bool read_row(const std::string& path, const TomlValue& row, std::size_t columns,
                std::vector<double>& values);
  bool read_number(const std::string& path, const TomlValue& value, Range<double> range,
                   double& out);
  std::string hint(const std::string& unknown) const;

  std::string file_;
  std::vector<ConfigFault>& faults_;
  TomlValues values_;
  std::set<std::string> known_;
  bool parsed_ = false;
};

}  // namespace binpick::app
