// What each of the 65536 codes of a 16-bit depth image means in mm; 0: no measurement. z,
// disparity, offset and invalid code are all in the table, so one look-up a pixel serves every
// sensor, and a scene's few thousand neighbouring codes stay in the nearest cache.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "binpick/drivers/depth_code.hpp"
#include "genicam/scan3d.hpp"

namespace binpick::drivers {

class DepthTable {
 public:
  DepthTable();
  // Makes the table anew where the values differ from the last ones. They are usable.
  void update(const Scan3d& scan3d);
  float mm(std::uint16_t code) const { return mm_[code]; }
  const float* data() const { return mm_.data(); }

 private:
  Scan3d scan3d_;
  bool made_ = false;
  std::vector<float> mm_;
};

// The same for one value of any type. `code` may be NaN.
float depth_mm_of(const Scan3d& scan3d, double code);

// An axis ready for long rows: no branches, so that the compiler can make vectors of it.
struct AxisInMm {
  double scale, offset, invalid_code;
  AxisInMm(const Scan3dAxis& axis, double mm_per_unit)
      : scale(axis.scale * mm_per_unit),
        offset(axis.offset * mm_per_unit),
        // Equal to nothing where every code is a measurement.
        invalid_code(axis.invalid_code.value_or(std::numeric_limits<double>::quiet_NaN())) {}
  // As depth_mm_of gives for z.
  float depth_mm(double code) const {
    const float z = depth_mm_from_code(code, scale, offset);
    const float positive = z > 0 ? z : 0.0f;
    const float finite = positive <= std::numeric_limits<float>::max() ? positive : 0.0f;
    return code == invalid_code ? 0.0f : finite;
  }
};

}  // namespace binpick::drivers
