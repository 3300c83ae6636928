#include "replay/depth_file.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/drivers/depth_code.hpp"
#include "binpick/drivers/loaded_frame.hpp"
#include "replay/exr_file.hpp"
#include "replay/npy_file.hpp"

namespace binpick::drivers {
namespace {

// No part lies nearer or farther than this; and as the ranges do not meet, a median tells metres
// from millimetres.
constexpr double kNearest_mm = 100, kFarthest_mm = 20000;
constexpr double kNoDistance_mm = 1e6;  // what renderers write for the background

std::string number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

bool is_distance(double mm) {
  return mm >= kNearest_mm && mm <= kFarthest_mm;
}

// 0: there is none.
double median(std::span<const float> depths) {
  std::vector<float> measured;
  for (const float d : depths)
    if (std::isfinite(d) && d > 0 && d < kNoDistance_mm) measured.push_back(d);
  if (measured.empty()) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

RawDepth read_raw(const std::string& path, const FileKind& kind) {
  if (kind.format == FileFormat::kExr) return read_exr_depth(path);
  if (kind.format == FileFormat::kNpy) return read_npy_depth(path);
  return read_depth_image(path);
}

}  // namespace

float float_depth_mm(float value, double mm_per_unit) {
  const double mm = static_cast<double>(value) * mm_per_unit;
  return mm > 0 && mm < kNoDistance_mm ? static_cast<float>(mm) : 0;
}

FloatUnit unit_of_floats(const std::string& path, std::span<const float> depths,
                         const DepthUnit& unit) {
  if (unit.asked_for) return {*unit.asked_for, ""};
  const double typical = median(depths);
  if (typical == 0) return {};
  const std::string holds =
      path + ": holds floating-point depth with a median of " + number_text(typical);
  // A camera file's depth_scale is mostly that of 16-bit images: here it is one unit among others.
  std::vector<double> possible;
  for (const double mm : {1.0, 1000.0, unit.camera_file.value_or(1)}) {
    const bool known = std::find(possible.begin(), possible.end(), mm) != possible.end();
    if (is_distance(typical * mm) && !known) possible.push_back(mm);
  }
  if (possible.size() != 1)
    throw DatasetError(holds +
                       ", of which the unit is not certain; give the mm per unit: "
                       "--depth-scale 1 for mm, 1000 for metres");
  const double mm = possible.front();
  const std::string scale = unit.camera_file ? number_text(*unit.camera_file) : "";
  std::string note =
      holds + (mm == 1      ? ", taken for mm"
               : mm == 1000 ? ", taken for metres"
                            : ", taken times the camera file's depth_scale of " + scale);
  if (unit.camera_file && *unit.camera_file != mm)
    note += "; the camera file's depth_scale of " + scale + " is left to 16-bit images";
  return {mm, note};
}

DepthImage read_depth(const std::string& path, const FileKind& kind, const DepthUnit& unit) {
  const RawDepth raw = read_raw(path, kind);
  DepthImage depth;
  depth.depth_mm = {raw.width, raw.height, {}};
  depth.depth_mm.pixels.reserve(raw.codes.total() + raw.values.size());
  if (!raw.values.empty()) {
    const FloatUnit found = unit_of_floats(path, raw.values, unit);
    depth.note = found.note;
    for (const float value : raw.values)
      depth.depth_mm.pixels.push_back(float_depth_mm(value, found.mm));
    return depth;
  }
  const std::optional<double> scale = unit.asked_for ? unit.asked_for : unit.camera_file;
  if (!scale) {
    throw DatasetError(path +
                       ": the camera file gives no depth_scale (mm per unit of the depth "
                       "image); add it, or give --depth-scale");
  }
  depth.step_mm = *scale;
  for (int y = 0; y < raw.codes.rows; ++y) {
    const std::uint16_t* row = raw.codes[y];
    for (int x = 0; x < raw.codes.cols; ++x)
      depth.depth_mm.pixels.push_back(depth_mm_from_code(row[x], *scale));
  }
  return depth;
}

}  // namespace binpick::drivers
