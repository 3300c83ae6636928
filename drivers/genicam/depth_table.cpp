#include "genicam/depth_table.hpp"

namespace binpick::drivers {

DepthTable::DepthTable() : mm_(65536) {}

void DepthTable::update(const Scan3d& scan3d) {
  if (made_ && scan3d == scan3d_) return;
  scan3d_ = scan3d;
  made_ = true;
  for (std::size_t code = 0; code < mm_.size(); ++code)
    mm_[code] = depth_mm_of(scan3d, static_cast<double>(code));
}

float depth_mm_of(const Scan3d& s, double code) {
  if (s.kind == DepthKind::kZ) return AxisInMm(s.c, s.mm_per_unit).depth_mm(code);
  if (s.c.invalid_code && code == *s.c.invalid_code) return 0;
  const double disparity_px = code * s.c.scale + s.c.offset;
  if (!(disparity_px > 0)) return 0;
  const float mm = static_cast<float>(s.focal_length_px * s.baseline_mm / disparity_px);
  return mm <= std::numeric_limits<float>::max() ? mm : 0;
}

}  // namespace binpick::drivers
