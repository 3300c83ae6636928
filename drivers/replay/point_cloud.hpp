// Point clouds of files. Only organized ones are of use: a grid of points as the sensor's image,
// with places for what was not measured.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace binpick::drivers {

constexpr std::size_t kPointsMax = 100'000'000;  // more than any sensor has

struct PointCloud {
  int width = 0, height = 0;                 // 0: the file tells no grid
  std::vector<std::array<float, 3>> points;  // not finite, or 0, 0, 0: no measurement
  std::vector<std::uint8_t> gray;            // of each point; empty where the file has none
  bool has_faces = false;                    // as a mesh does, and some organized clouds
};

// ASCII and binary, of either byte order. The grid is taken from "obj_info num_cols" and
// "num_rows", from a comment that names width and height, or from a range_grid. Throws
// DatasetError.
PointCloud read_ply(const std::string& path);

// ASCII, binary and compressed. The grid is WIDTH and HEIGHT. Throws DatasetError.
PointCloud read_pcd(const std::string& path);

// Numbers as both formats have them.
enum class NumberType { kI8, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };
int bytes_of(NumberType type);
double number_at(const char* bytes, NumberType type, bool big_endian);

// What a property or field of a point is; kNone: of no use here.
enum class PointField { kNone, kX, kY, kZ, kGray, kRed, kGreen, kBlue, kPackedColour };
PointField point_field(std::string_view name);

// Puts points together from their numbers, as they come.
class PointCollector {
 public:
  explicit PointCollector(std::size_t count) { points_.reserve(count); }
  void begin_point();
  void set(PointField field, double number);
  void end_point();
  // Gray is scaled to 8 bits by the largest value: up to 1, 255, or what 16 bits hold.
  PointCloud finish() &&;

 private:
  std::vector<std::array<float, 3>> points_;
  std::array<float, 3> point_{};
  std::array<double, 3> colour_{};
  double gray_ = 0;
  bool has_gray_ = false, has_colour_ = false;
  std::vector<float> grays_;
};

// The numbers of a text between blanks, one after the other.
class NumberText {
 public:
  explicit NumberText(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}
  bool next(double& number);  // "nan" too; false at the end, and where there is no number

 private:
  const char* at_;
  const char* end_;
};

// The whole file.
std::string read_bytes(const std::string& path);

}  // namespace binpick::drivers
