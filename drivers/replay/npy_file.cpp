#include "replay/npy_file.hpp"

#include <Eigen/Core>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string_view>

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {
namespace {

constexpr std::size_t kPreamble = 8;  // mark and version
constexpr long kNpySideMax = 65535;

// The value after 'key': in the header, which is a Python dictionary.
std::string_view header_value(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) return {};
  const std::size_t colon = header.find(':', at);
  if (colon == std::string_view::npos) return {};
  header.remove_prefix(colon + 1);
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

std::vector<long> shape_of(std::string_view text) {
  std::vector<long> shape;
  const char* p = text.data();
  const char* const end = p + text.find(')');
  while (p < end) {
    long side = 0;
    const auto [stop, error] = std::from_chars(p, end, side);
    if (error == std::errc()) shape.push_back(side);
    p = error == std::errc() ? stop : p + 1;
  }
  return shape;
}

std::string shape_text(const std::vector<long>& shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(shape[i]);
  return text + ")";
}

template <class From, class To>
void convert(std::string_view bytes, std::vector<To>& to) {
  for (std::size_t at = 0; at + sizeof(From) <= bytes.size(); at += sizeof(From)) {
    From value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    to.push_back(static_cast<To>(value));
  }
}

struct NpyHeader {
  std::string type;
  bool by_columns = false;
  std::vector<long> shape;
};

NpyHeader read_npy_header(const std::string& path, std::ifstream& file) {
  char preamble[kPreamble] = {};
  file.read(preamble, sizeof preamble);
  unsigned char size[4] = {};
  const bool version1 = preamble[6] == 1;
  file.read(reinterpret_cast<char*>(size), version1 ? 2 : 4);
  const std::size_t bytes = size[0] + 256u * size[1] + 65536u * size[2];
  std::string text(bytes, ' ');
  file.read(text.data(), static_cast<std::streamsize>(bytes));
  NpyHeader header;
  const std::string_view type = header_value(text, "'descr'");
  const std::string_view order = header_value(text, "'fortran_order'");
  const std::string_view shape = header_value(text, "'shape'");
  if (!file || size[3] != 0 || type.empty() || order.empty() ||
      shape.find(')') == std::string_view::npos)
    throw DatasetError(path + ": its header is damaged: save it again with numpy.save");
  if (type.front() == '\'') header.type = type.substr(1, type.find('\'', 1) - 1);
  header.by_columns = order.starts_with("True");
  header.shape = shape_of(shape);
  return header;
}

void check_npy(const std::string& path, const NpyHeader& h) {
  const std::string save = ": numpy.save('depth.npy', ";
  if (h.type.starts_with(">"))
    throw DatasetError(path + ": is big-endian (" + h.type + ")" + save +
                       "depth.astype(depth.dtype.newbyteorder('<')))");
  if (h.by_columns && h.shape.size() > 1)
    throw DatasetError(path + ": is stored column by column (Fortran order)" + save +
                       "numpy.ascontiguousarray(depth))");
  const bool flat = h.shape.size() == 3 && h.shape[2] == 1;
  if (h.shape.size() != 2 && !flat) {
    const bool points = h.shape.size() == 3 && h.shape[2] >= 3;
    throw DatasetError(path + ": has the shape " + shape_text(h.shape) +
                       ", expected is (height, width)" + save +
                       (points ? "points[:, :, 2]), the z of its points" : "depth)"));
  }
  if (h.shape[0] < 1 || h.shape[1] < 1 || h.shape[0] > kNpySideMax || h.shape[1] > kNpySideMax)
    throw DatasetError(path + ": has the shape " + shape_text(h.shape) + ", which is no image");
  if (h.type != "<f4" && h.type != "<f8" && h.type != "<f2" && h.type != "<u2")
    throw DatasetError(path + ": holds numbers of type '" + h.type +
                       "', expected are float32, float64 or uint16" + save +
                       "depth.astype('float32'))");
}

}  // namespace

RawDepth read_npy_depth(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const NpyHeader header = read_npy_header(path, file);
  check_npy(path, header);
  RawDepth depth{static_cast<int>(header.shape[1]), static_cast<int>(header.shape[0]), {}, {}};
  const auto count = static_cast<std::size_t>(header.shape[0] * header.shape[1]);
  const std::size_t bytes = count * static_cast<std::size_t>(header.type[2] - '0');
  const std::streampos begin = file.tellg();
  file.seekg(0, std::ios::end);
  const auto there = static_cast<std::size_t>(file.tellg() - begin);
  if (there != bytes) {
    throw DatasetError(path + ": is cut short or damaged: " + shape_text(header.shape) + " of '" +
                       header.type + "' takes " + std::to_string(bytes) + " bytes, there are " +
                       std::to_string(there));
  }
  file.seekg(begin);
  std::string data(bytes, '\0');
  file.read(data.data(), static_cast<std::streamsize>(bytes));
  if (header.type == "<u2") {
    depth.codes.create(depth.height, depth.width);
    std::memcpy(depth.codes.data, data.data(), data.size());
  }
  if (header.type == "<f2") convert<Eigen::half>(data, depth.values);
  if (header.type == "<f4") convert<float>(data, depth.values);
  if (header.type == "<f8") convert<double>(data, depth.values);
  return depth;
}

}  // namespace binpick::drivers
