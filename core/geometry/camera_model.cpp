#include "binpick/geometry/camera_model.hpp"

#include <cmath>

namespace binpick {

bool CameraIntrinsics::valid() const {
  return std::isfinite(fx) && std::isfinite(fy) && std::isfinite(cx) && std::isfinite(cy) &&
         fx > 0 && fy > 0;
}

// Block (0, 0) of 2^l x 2^l pixels has its centre at ((2^l - 1) / 2, (2^l - 1) / 2).
CameraIntrinsics CameraIntrinsics::at_level(int level) const {
  const double s = 1.0 / (1 << level);
  CameraIntrinsics c;
  c.width = width >> level;
  c.height = height >> level;
  c.fx = fx * s;
  c.fy = fy * s;
  c.cx = (cx + 0.5) * s - 0.5;
  c.cy = (cy + 0.5) * s - 0.5;
  return c;
}

}  // namespace binpick
