#include "ply_input.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct Type {
  std::size_t bytes = 0;
  bool is_real = false;
};

struct Property {
  bool is_list = false;
  Type count, value;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  std::size_t line_end = 0;    // behind the word end_header
  std::size_t data_begin = 0;  // behind its line
};

// Takes the next word, empty at the end of the text.
std::string_view take_word(std::string_view& text) {
  constexpr const char* kBlank = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlank));
  text.remove_prefix(word.size());
  return word;
}

template <class T>
bool to_number(std::string_view word, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

Type type_of(std::string_view name) {
  constexpr struct {
    const char* names[2];
    Type type;
  } kTypes[] = {{{"char", "int8"}, {1, false}},    {{"uchar", "uint8"}, {1, false}},
                {{"short", "int16"}, {2, false}},  {{"ushort", "uint16"}, {2, false}},
                {{"int", "int32"}, {4, false}},    {{"uint", "uint32"}, {4, false}},
                {{"float", "float32"}, {4, true}}, {{"double", "float64"}, {8, true}}};
  for (const auto& known : kTypes) {
    if (name == known.names[0] || name == known.names[1]) return known.type;
  }
  throw ImportError("its header has a property of the unknown type '" + std::string(name) + "'");
}

Encoding encoding_of(std::string_view name) {
  if (name == "ascii") return Encoding::kAscii;
  if (name == "binary_little_endian") return Encoding::kLittleEndian;
  if (name == "binary_big_endian") return Encoding::kBigEndian;
  throw ImportError("its header has the unknown format '" + std::string(name) + "'");
}

void read_header_line(std::string_view line, Header& header) {
  const std::string_view key = take_word(line);
  if (key == "format") {
    header.encoding = encoding_of(take_word(line));
  } else if (key == "element") {
    Element element;
    element.name = take_word(line);
    if (!to_number(take_word(line), element.count)) {
      throw ImportError("its header does not say how many of '" + element.name + "' there are");
    }
    header.elements.push_back(std::move(element));
  } else if (key == "property") {
    if (header.elements.empty()) throw ImportError("its header has a property of no element");
    Property property;
    std::string_view type = take_word(line);
    property.is_list = type == "list";
    if (property.is_list) {
      property.count = type_of(take_word(line));
      if (property.count.is_real) throw ImportError("its header counts a list in fractions");
      type = take_word(line);
    }
    property.value = type_of(type);
    header.elements.back().properties.push_back(property);
  }
}

Header read_header(std::string_view bytes) {
  if (bytes.substr(0, 3) != "ply" && bytes.substr(0, 3) != "PLY")
    throw ImportError("it does not begin with the word ply");
  Header header;
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\n', begin)) != bytes.npos;
       begin = end + 1) {
    const std::string_view line = bytes.substr(begin, end - begin);
    if (std::string_view rest = line; take_word(rest) == "end_header") {
      header.line_end = end - rest.size();
      header.data_begin = end + 1;
      return header;
    }
    read_header_line(line, header);
  }
  throw ImportError("its header has no line end_header, so it was cut short or is no PLY file");
}

// Walks through the data of one element after the other; false where they end too early.
class Walk {
 public:
  Walk(Encoding encoding, std::string_view data) : encoding_(encoding), data_(data) {}

  bool skip(const Property& property) {
    std::uint64_t count = 1;
    if (property.is_list && !take_count(property.count, count)) return false;
    if (encoding_ == Encoding::kAscii) return skip_words(count);
    if (count > data_.size() / property.value.bytes) return false;
    data_.remove_prefix(count * property.value.bytes);
    return true;
  }

 private:
  bool skip_words(std::uint64_t count) {
    for (; count > 0; --count) {
      if (take_word(data_).empty()) return false;
    }
    return true;
  }

  bool take_count(const Type& type, std::uint64_t& count) {
    if (encoding_ == Encoding::kAscii) {
      const std::string_view word = take_word(data_);
      if (word.empty()) return false;
      if (to_number(word, count)) return true;
      throw ImportError("a list in it has the length '" + std::string(word.substr(0, 20)) + "'");
    }
    if (data_.size() < type.bytes) return false;
    count = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t place = encoding_ == Encoding::kLittleEndian ? i : type.bytes - 1 - i;
      count |= std::uint64_t{static_cast<unsigned char>(data_[i])} << 8 * place;
    }
    data_.remove_prefix(type.bytes);
    return true;
  }

  Encoding encoding_;
  std::string_view data_;
};

void check_data(const Header& header, std::string_view data) {
  Walk walk(header.encoding, data);
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        if (walk.skip(property)) continue;
        throw ImportError("it ends within " + element.name + " " + std::to_string(i + 1) + " of " +
                          std::to_string(element.count) + ", so it was cut short");
      }
    }
  }
}

}  // namespace

void complete_ply(std::string& bytes) {
  const Header header = read_header(bytes);
  check_data(header, std::string_view(bytes).substr(header.data_begin));
  // Of binary data assimp drops a leading line feed, which it takes for the second half of a line's
  // end: there is always one for it.
  if (header.encoding == Encoding::kAscii) return;
  bytes.replace(header.line_end, header.data_begin - header.line_end, "\r\n");
}

}  // namespace binpick::train
