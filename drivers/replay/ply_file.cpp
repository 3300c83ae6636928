#include <algorithm>
#include <charconv>
#include <optional>
#include <regex>
#include <sstream>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/point_cloud.hpp"

namespace binpick::drivers {
namespace {

constexpr std::size_t kPlyHeaderBytesMax = 64 << 10;

struct PlyProperty {
  NumberType type;
  std::optional<NumberType> count_type;  // of a list
  PointField field;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  enum { kAscii, kLittleEndian, kBigEndian } format = kAscii;
  std::vector<PlyElement> elements;
  int width = 0, height = 0;
  std::size_t bytes = 0;
};

NumberType ply_type(const std::string& path, const std::string& name) {
  using enum NumberType;
  static const std::pair<const char*, NumberType> kNames[] = {
      {"char", kI8},   {"int8", kI8},     {"uchar", kU8},   {"uint8", kU8},
      {"short", kI16}, {"int16", kI16},   {"ushort", kU16}, {"uint16", kU16},
      {"int", kI32},   {"int32", kI32},   {"uint", kU32},   {"uint32", kU32},
      {"float", kF32}, {"float32", kF32}, {"double", kF64}, {"float64", kF64}};
  for (const auto& [known, type] : kNames)
    if (name == known) return type;
  throw DatasetError(path + ": its header has a property of the unknown type '" + name + "'");
}

// "num_cols 640", "width: 640", "cols=640", wherever in a line. What obj_info says is the grid; a
// comment may speak of something else.
void take_grid(const std::string& line, bool obj_info, PlyHeader& header) {
  static const std::regex columns("(num_cols|width|columns|cols)[ :=]+([0-9]{1,6})",
                                  std::regex::icase);
  static const std::regex rows("(num_rows|height|rows)[ :=]+([0-9]{1,6})", std::regex::icase);
  const auto take = [&](const std::regex& words, int& size) {
    std::smatch found;
    if ((obj_info || size == 0) && std::regex_search(line, found, words))
      size = std::stoi(found[2]);
  };
  take(columns, header.width);
  take(rows, header.height);
}

void take_property(const std::string& path, std::istringstream& words, PlyHeader& header) {
  std::string type, name;
  words >> type;
  if (header.elements.empty())
    throw DatasetError(path + ": its header has a property of no element");
  PlyProperty property{};
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    property.count_type = ply_type(path, count_type);
  }
  words >> name;
  property.type = ply_type(path, type);
  property.field = point_field(name);
  header.elements.back().properties.push_back(property);
}

PlyHeader read_ply_header(const std::string& path, const std::string& bytes) {
  PlyHeader header;
  std::size_t at = 0;
  while (at < std::min(bytes.size(), kPlyHeaderBytesMax)) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) break;
    std::istringstream words(bytes.substr(at, end - at));
    std::string word;
    words >> word;
    at = end + 1;
    if (word == "format") {
      words >> word;
      if (word == "binary_little_endian") header.format = PlyHeader::kLittleEndian;
      if (word == "binary_big_endian") header.format = PlyHeader::kBigEndian;
    } else if (word == "comment" || word == "obj_info") {
      take_grid(words.str(), word == "obj_info", header);
    } else if (word == "element") {
      PlyElement element;
      words >> element.name >> element.count;
      if (!words || element.count > kPointsMax)
        throw DatasetError(path + ": its header has an element without a usable count");
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      take_property(path, words, header);
    } else if (word == "end_header") {
      header.bytes = at;
      return header;
    }
  }
  throw DatasetError(path + ": its PLY header has no end_header: the file is cut short or damaged");
}

// The numbers of the body in their order, whatever the encoding.
class PlyBody {
 public:
  PlyBody(const std::string& path, const std::string& bytes, const PlyHeader& header)
      : path_(path),
        bytes_(bytes),
        header_(header),
        at_(header.bytes),
        text_(std::string_view(bytes).substr(header.bytes)) {}

  double next(NumberType type) {
    double number = 0;
    if (header_.format == PlyHeader::kAscii) {
      if (!text_.next(number)) cut_short();
      return number;
    }
    const auto size = static_cast<std::size_t>(bytes_of(type));
    if (bytes_.size() - at_ < size) cut_short();
    number = number_at(bytes_.data() + at_, type, header_.format == PlyHeader::kBigEndian);
    at_ += size;
    return number;
  }

  [[noreturn]] void cut_short() const {
    throw DatasetError(path_ +
                       ": ends before all of its points, or holds what is no number: the file is "
                       "cut short or damaged");
  }

 private:
  const std::string& path_;
  const std::string& bytes_;
  const PlyHeader& header_;
  std::size_t at_;
  NumberText text_;
};

// How often a property comes: lists have a count of their own.
std::size_t repeats(const PlyProperty& property, PlyBody& body) {
  if (!property.count_type) return 1;
  const double count = body.next(*property.count_type);
  if (!(count >= 0 && count <= static_cast<double>(kPointsMax))) body.cut_short();
  return static_cast<std::size_t>(count);
}

PointCloud read_vertices(const PlyElement& element, PlyBody& body) {
  PointCollector collector(element.count);
  for (std::size_t i = 0; i < element.count; ++i) {
    collector.begin_point();
    for (const PlyProperty& property : element.properties) {
      for (std::size_t n = repeats(property, body); n > 0; --n) {
        const double number = body.next(property.type);
        if (!property.count_type) collector.set(property.field, number);
      }
    }
    collector.end_point();
  }
  return std::move(collector).finish();
}

// Of each place of the grid the index of its point, or none: Stanford's range images.
PointCloud spread_over_grid(const std::string& path, const PointCloud& measured,
                            const PlyElement& grid, PlyBody& body) {
  PointCloud cloud;
  cloud.points.resize(grid.count);
  if (!measured.gray.empty()) cloud.gray.resize(grid.count);
  for (std::size_t i = 0; i < grid.count; ++i) {
    for (const PlyProperty& property : grid.properties) {
      for (std::size_t n = repeats(property, body); n > 0; --n) {
        const double index = body.next(property.type);
        if (!(index >= 0 && index < static_cast<double>(measured.points.size())))
          throw DatasetError(path + ": its range_grid refers to a point that it does not hold");
        const auto point = static_cast<std::size_t>(index);
        cloud.points[i] = measured.points[point];
        if (!measured.gray.empty()) cloud.gray[i] = measured.gray[point];
      }
    }
  }
  return cloud;
}

void skip(const PlyElement& element, PlyBody& body) {
  for (std::size_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties)
      for (std::size_t n = repeats(property, body); n > 0; --n) body.next(property.type);
}

}  // namespace

PointCloud read_ply(const std::string& path) {
  const std::string bytes = read_bytes(path);
  const PlyHeader header = read_ply_header(path, bytes);
  const auto element = [&](const char* name) {
    return std::find_if(header.elements.begin(), header.elements.end(),
                        [&](const PlyElement& e) { return e.name == name; });
  };
  const auto vertices = element("vertex"), grid = element("range_grid");
  if (vertices == header.elements.end())
    throw DatasetError(path + ": is a PLY file without points (vertex)");
  PlyBody body(path, bytes, header);
  PointCloud cloud;
  for (auto it = header.elements.begin(); it != header.elements.end(); ++it) {
    if (it == vertices)
      cloud = read_vertices(*it, body);
    else if (it == grid && it > vertices)
      cloud = spread_over_grid(path, cloud, *it, body);
    else if (it < vertices || (grid != header.elements.end() && it < grid))
      skip(*it, body);
  }
  const auto faces = element("face");
  cloud.has_faces = faces != header.elements.end() && faces->count > 0;
  cloud.width = header.width;
  cloud.height = header.height;
  return cloud;
}

}  // namespace binpick::drivers
