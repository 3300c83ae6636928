// Depth images of any format, in mm.
#pragma once

#include <optional>
#include <span>

#include "replay/file_kind.hpp"
#include "replay/image_file.hpp"

namespace binpick::drivers {

// mm per unit of what a file holds, by who says so.
struct DepthUnit {
  std::optional<double> asked_for;    // by the user, for this very file: it decides
  std::optional<double> camera_file;  // for the depth images of this camera
};

struct DepthImage {
  ImageBuffer<float> depth_mm;  // 0: no measurement
  double step_mm = 0;           // depths are whole numbers times this; 0: any numbers
  std::string note;             // on the unit, where the file left it open; else empty
};

// Whole numbers need a unit from someone. Numbers of floating point have the one unit (mm, metres,
// the camera file's) in which they are distances; where that is not one alone, the error asks.
DepthImage read_depth(const std::string& path, const FileKind& kind, const DepthUnit& unit);

struct FloatUnit {
  double mm = 1;
  std::string note;
};
// The rule for floating point, on the distances that were measured.
FloatUnit unit_of_floats(const std::string& path, std::span<const float> depths,
                         const DepthUnit& unit);

// In mm; 0 for what is no distance.
float float_depth_mm(float value, double mm_per_unit);

}  // namespace binpick::drivers
