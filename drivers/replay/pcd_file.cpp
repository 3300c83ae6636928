#include <liblzf/lzf.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <sstream>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/point_cloud.hpp"

namespace binpick::drivers {
namespace {

constexpr std::size_t kHeaderLinesMax = 64;
constexpr std::size_t kValuesMax = 4096;  // of one field: histograms have hundreds

struct PcdField {
  PointField field;
  NumberType type;
  std::size_t count, offset;  // offset: in a point's bytes
  std::size_t bytes() const { return count * static_cast<std::size_t>(bytes_of(type)); }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t width = 0, height = 0, points = 0, point_bytes = 0;
  std::string data;
  std::size_t bytes = 0;
};

[[noreturn]] void damaged(const std::string& path, const std::string& what) {
  throw DatasetError(path + ": " + what + ": the file is cut short or damaged");
}

NumberType pcd_type(const std::string& path, const std::string& kind, const std::string& size) {
  using enum NumberType;
  static const std::map<std::string, NumberType> kTypes = {{"I1", kI8},  {"U1", kU8},  {"I2", kI16},
                                                           {"U2", kU16}, {"I4", kI32}, {"U4", kU32},
                                                           {"F4", kF32}, {"F8", kF64}};
  const auto type = kTypes.find(kind + size);
  if (type != kTypes.end()) return type->second;
  throw DatasetError(path + ": its header has a field of TYPE " + kind + " and SIZE " + size +
                     ", which is not supported");
}

std::size_t whole_number(const std::string& path, const std::string& text, std::size_t most) {
  std::size_t number = 0;
  std::istringstream words(text);
  if (!(words >> number) || number > most)
    damaged(path, "its header has '" + text + "' for a number");
  return number;
}

PcdHeader pcd_header(const std::string& path,
                     std::map<std::string, std::vector<std::string>>& lines) {
  PcdHeader header;
  const std::vector<std::string>& names = lines["FIELDS"];
  std::vector<std::string>& counts = lines["COUNT"];
  if (counts.empty()) counts.assign(names.size(), "1");
  if (names.empty() || lines["SIZE"].size() != names.size() ||
      lines["TYPE"].size() != names.size() || counts.size() != names.size())
    damaged(path, "its header does not tell FIELDS, SIZE, TYPE and COUNT alike");
  for (std::size_t i = 0; i < names.size(); ++i) {
    PcdField field{point_field(names[i]), pcd_type(path, lines["TYPE"][i], lines["SIZE"][i]),
                   whole_number(path, counts[i], kValuesMax), header.point_bytes};
    header.point_bytes += field.bytes();
    header.fields.push_back(field);
  }
  for (const char* needed : {"WIDTH", "HEIGHT", "DATA"})
    if (lines[needed].empty()) damaged(path, std::string("its header has no ") + needed);
  header.width = whole_number(path, lines["WIDTH"][0], kPointsMax);
  header.height = whole_number(path, lines["HEIGHT"][0], kPointsMax);
  header.points = header.width * header.height;
  if (header.points > kPointsMax) damaged(path, "its WIDTH and HEIGHT are larger than any sensor");
  header.data = lines["DATA"][0];
  return header;
}

PcdHeader read_pcd_header(const std::string& path, const std::string& bytes) {
  std::map<std::string, std::vector<std::string>> lines;
  std::size_t at = 0;
  for (std::size_t i = 0; i < kHeaderLinesMax && lines["DATA"].empty(); ++i) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) break;
    std::istringstream words(bytes.substr(at, end - at));
    at = end + 1;
    std::string key, word;
    words >> key;
    if (key.starts_with("#")) continue;
    while (words >> word) lines[key].push_back(word);
  }
  PcdHeader header = pcd_header(path, lines);
  header.bytes = at;
  return header;
}

void set_field(PointCollector& collector, const PcdField& field, double number) {
  // Colour is packed into the bits of a float, where it is one.
  if (field.field == PointField::kPackedColour && field.type == NumberType::kF32)
    number = std::bit_cast<std::uint32_t>(static_cast<float>(number));
  collector.set(field.field, number);
}

PointCloud read_ascii(const std::string& path, const std::string& bytes, const PcdHeader& header) {
  PointCollector collector(std::min(header.points, bytes.size()));
  NumberText text(std::string_view(bytes).substr(header.bytes));
  for (std::size_t i = 0; i < header.points; ++i) {
    collector.begin_point();
    for (const PcdField& field : header.fields) {
      for (std::size_t n = 0; n < field.count; ++n) {
        double number = 0;
        if (!text.next(number))
          damaged(path, "point " + std::to_string(i) + " of " + std::to_string(header.points) +
                            " is no row of numbers");
        if (n == 0) set_field(collector, field, number);
      }
    }
    collector.end_point();
  }
  return std::move(collector).finish();
}

// One field after the other, each of all points, compressed as one.
std::string unpack(const std::string& path, std::string_view packed, const PcdHeader& header) {
  std::uint32_t sizes[2] = {};
  if (packed.size() < sizeof sizes) damaged(path, "its compressed data have no size");
  std::memcpy(sizes, packed.data(), sizeof sizes);
  packed.remove_prefix(sizeof sizes);
  const std::size_t expected = header.points * header.point_bytes;
  if (sizes[0] > packed.size() || sizes[1] != expected)
    damaged(path, "its compressed data are not of the size that they tell");
  std::string unpacked(expected, '\0');
  if (lzf_decompress(packed.data(), sizes[0], unpacked.data(), sizes[1]) != sizes[1])
    damaged(path, "its compressed data cannot be unpacked");
  return unpacked;
}

PointCloud read_binary(const std::string& path, const std::string& bytes, const PcdHeader& header) {
  const bool compressed = header.data == "binary_compressed";
  std::string_view data = std::string_view(bytes).substr(header.bytes);
  std::string unpacked;
  if (compressed) data = unpacked = unpack(path, data, header);
  if (data.size() < header.points * header.point_bytes)
    damaged(path, "has " +
                      std::to_string(data.size() / std::max<std::size_t>(header.point_bytes, 1)) +
                      " points where its header tells " + std::to_string(header.points));
  PointCollector collector(header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    collector.begin_point();
    for (const PcdField& field : header.fields) {
      if (field.count == 0) continue;
      const std::size_t at = compressed ? field.offset * header.points + i * field.bytes()
                                        : i * header.point_bytes + field.offset;
      set_field(collector, field, number_at(data.data() + at, field.type, false));
    }
    collector.end_point();
  }
  return std::move(collector).finish();
}

}  // namespace

PointCloud read_pcd(const std::string& path) {
  const std::string bytes = read_bytes(path);
  const PcdHeader header = read_pcd_header(path, bytes);
  PointCloud cloud;
  if (header.data == "ascii")
    cloud = read_ascii(path, bytes, header);
  else if (header.data == "binary" || header.data == "binary_compressed")
    cloud = read_binary(path, bytes, header);
  else
    throw DatasetError(path + ": its DATA is '" + header.data +
                       "', expected are ascii, binary or binary_compressed");
  if (header.height > 1 && header.width > 1) {
    cloud.width = static_cast<int>(header.width);
    cloud.height = static_cast<int>(header.height);
  }
  return cloud;
}

}  // namespace binpick::drivers
