#include "replay/point_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "binpick/drivers/loaded_frame.hpp"
#include "replay/image_file.hpp"

namespace binpick::drivers {
namespace {

template <class T>
double load(const char* bytes, bool big_endian) {
  char copy[sizeof(T)];
  std::memcpy(copy, bytes, sizeof copy);
  if (big_endian) std::reverse(copy, copy + sizeof copy);
  T number;
  std::memcpy(&number, copy, sizeof number);
  return static_cast<double>(number);
}

std::vector<std::uint8_t> gray_of_values(const std::vector<float>& values) {
  float largest = 0;
  for (const float v : values)
    if (std::isfinite(v)) largest = std::max(largest, v);
  const float scale = largest <= 1 ? 255.0f : 1.0f;
  std::vector<std::uint16_t> codes;
  codes.reserve(values.size());
  for (const float v : values) {
    const float code = std::isfinite(v) ? std::clamp(v * scale, 0.0f, 65535.0f) : 0.0f;
    codes.push_back(static_cast<std::uint16_t>(std::lround(code)));
  }
  return gray_of_codes(codes);
}

}  // namespace

int bytes_of(NumberType type) {
  constexpr int kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(type)];
}

double number_at(const char* bytes, NumberType type, bool big_endian) {
  switch (type) {
    case NumberType::kI8:
      return load<std::int8_t>(bytes, big_endian);
    case NumberType::kU8:
      return load<std::uint8_t>(bytes, big_endian);
    case NumberType::kI16:
      return load<std::int16_t>(bytes, big_endian);
    case NumberType::kU16:
      return load<std::uint16_t>(bytes, big_endian);
    case NumberType::kI32:
      return load<std::int32_t>(bytes, big_endian);
    case NumberType::kU32:
      return load<std::uint32_t>(bytes, big_endian);
    case NumberType::kF32:
      return load<float>(bytes, big_endian);
    case NumberType::kF64:
      break;
  }
  return load<double>(bytes, big_endian);
}

PointField point_field(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (c != '_') plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (plain == "x") return PointField::kX;
  if (plain == "y") return PointField::kY;
  if (plain == "z") return PointField::kZ;
  if (plain == "red" || plain == "r") return PointField::kRed;
  if (plain == "green" || plain == "g") return PointField::kGreen;
  if (plain == "blue" || plain == "b") return PointField::kBlue;
  if (plain == "rgb" || plain == "rgba") return PointField::kPackedColour;
  if (plain.starts_with("scalar")) plain.erase(0, 6);  // CloudCompare's
  for (const char* gray : {"intensity", "gray", "grey", "texture", "luminance", "brightness"})
    if (plain.starts_with(gray)) return PointField::kGray;
  return PointField::kNone;
}

void PointCollector::begin_point() {
  point_ = {};
  colour_ = {};
  gray_ = 0;
}

void PointCollector::set(PointField field, double number) {
  const auto packed = static_cast<std::uint32_t>(
      std::isfinite(number) ? std::clamp(number, 0.0, 4294967295.0) : 0.0);
  switch (field) {
    case PointField::kX:
    case PointField::kY:
    case PointField::kZ:
      point_[static_cast<std::size_t>(field) - static_cast<std::size_t>(PointField::kX)] =
          static_cast<float>(number);
      break;
    case PointField::kGray:
      gray_ = number;
      has_gray_ = true;
      break;
    case PointField::kRed:
    case PointField::kGreen:
    case PointField::kBlue:
      colour_[static_cast<std::size_t>(field) - static_cast<std::size_t>(PointField::kRed)] =
          number;
      has_colour_ = true;
      break;
    case PointField::kPackedColour:
      for (std::size_t i = 0; i < 3; ++i) colour_[i] = packed >> (16 - 8 * i) & 0xff;
      has_colour_ = true;
      break;
    case PointField::kNone:
      break;
  }
}

void PointCollector::end_point() {
  points_.push_back(point_);
  if (has_gray_)
    grays_.push_back(static_cast<float>(gray_));
  else if (has_colour_)
    grays_.push_back(
        static_cast<float>(0.299 * colour_[0] + 0.587 * colour_[1] + 0.114 * colour_[2]));
}

PointCloud PointCollector::finish() && {
  PointCloud cloud;
  cloud.points = std::move(points_);
  if (grays_.size() == cloud.points.size()) cloud.gray = gray_of_values(grays_);
  return cloud;
}

bool NumberText::next(double& number) {
  while (at_ != end_ && std::isspace(static_cast<unsigned char>(*at_))) ++at_;
  if (at_ != end_ && *at_ == '+') ++at_;
  const auto [stop, error] = std::from_chars(at_, end_, number);
  if (error != std::errc()) return false;
  at_ = stop;
  return true;
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file) throw DatasetError(path + ": cannot be read");
  return std::move(bytes).str();
}

}  // namespace binpick::drivers
