#include "config/config_writer.hpp"

#include <cstdio>
#include <cstring>

#include "config/config_keys.hpp"

namespace binpick::app {
namespace {

class TomlWriter final : public KeyVisitor {
 public:
  std::string written;

  void flag(const Key& key, bool& value) override { add(key, value ? "true" : "false"); }
  void integer(const Key& key, int& value, Range<int>) override { add(key, std::to_string(value)); }
  void number(const Key& key, double& value, Range<double>) override { add(key, exact(value)); }
  void text(const Key& key, std::string& value) override { add(key, quoted(value)); }
  void choice(const Key& key, int& value, std::span<const char* const> names) override {
    add(key, quoted(names[static_cast<std::size_t>(value)]));
  }
  void numbers(const Key& key, std::span<double> values, Range<double>) override {
    add_list(key, values, exact);
  }
  void integers(const Key& key, std::vector<int>& values, Range<int>) override {
    add_list(key, values, [](int value) { return std::to_string(value); });
  }
  void matrix(const Key& key, std::vector<double>& values, std::size_t rows,
              std::size_t columns) override {
    if (rows == 1 || values.empty()) return add_list(key, values, exact);
    std::vector<std::string> lines;
    for (std::size_t r = 0; r < rows; ++r) {
      std::string line;
      for (std::size_t c = 0; c < columns; ++c)
        line += (line.empty() ? "" : ", ") + exact(values[r * columns + c]);
      lines.push_back("[" + line + "]");
    }
    add_list(key, lines, [](const std::string& line) { return line; });
  }
  void texts(const Key& key, std::vector<std::string>& values) override {
    add_list(key, values, quoted);
  }

 private:
  static std::string exact(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return std::strpbrk(text, ".e") != nullptr ? text : std::string(text) + ".0";
  }

  static std::string quoted(const std::string& value) {
    std::string text = "\"";
    for (const char c : value) {
      const auto byte = static_cast<unsigned char>(c);
      char escaped[8];
      if (c == '"' || c == '\\') {
        text += {'\\', c};
      } else if (byte < 0x20 || byte == 0x7F) {
        std::snprintf(escaped, sizeof escaped, "\\u%04X", static_cast<unsigned>(byte));
        text += escaped;
      } else {
        text += c;
      }
    }
    return text + '"';
  }

  template <class Values, class Write>
  void add_list(const Key& key, const Values& values, Write write) {
    std::string list;
    for (const auto& value : values) list += (list.empty() ? "" : ", ") + write(value);
    add(key, "[" + list + "]");
  }

  void add(const Key& key, const std::string& value) {
    written += std::string(key.path) + " = " + value + "\n";
  }
};

template <class Part>
std::string written_keys(Part part) {
  TomlWriter writer;
  visit_keys(part, writer);
  return writer.written;
}

}  // namespace

std::string written_config(const Config& config) {
  return written_keys(config);
}

std::string written_recipe(const RecipeConfig& recipe) {
  return written_keys(recipe);
}

}  // namespace binpick::app
