// How a lens bends rays, in OpenCV's model: radial polynomials and tangential terms.
#pragma once

#include <array>
#include <optional>

#include "binpick/geometry/camera_model.hpp"

namespace binpick {

struct LensDistortion {
  // In OpenCV's order; fewer than eight are filled up with zeros.
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;

  bool none() const;
  // Where the lens shows the point that a pinhole camera would show at `p`; both are (X/Z, Y/Z).
  Vec2 distort(const Vec2& p) const;
};

// A polynomial that was fitted to the middle of an image may turn back towards its corners, so that
// two rays share a pixel: the model is then wrong there. Gives the distance from the principal
// point, in px, at which that happens inside the image; nothing when it does not happen.
std::optional<double> fold_radius_px(const LensDistortion& lens, const CameraIntrinsics& camera);

}  // namespace binpick
