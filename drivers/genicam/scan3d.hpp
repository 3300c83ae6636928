// How a sensor's numbers become millimetres: the Scan3d* features of the GenICam Standard Features
// Naming Convention, as plain values. Read per axis when the sensor starts; chunks of a frame may
// replace some of them.
#pragma once

#include <optional>
#include <string>

#include "binpick/geometry/camera_model.hpp"

namespace binpick::drivers {

// value = code * scale + offset, in the sensor's unit of length (disparity: in px).
struct Scan3dAxis {
  double scale = 1, offset = 0;
  std::optional<double> invalid_code;  // this code is no measurement
  bool operator==(const Scan3dAxis&) const = default;
};

enum class DepthKind { kZ, kDisparity };

struct Scan3d {
  DepthKind kind = DepthKind::kZ;
  Scan3dAxis a, b, c;      // x, y, and z or disparity
  double mm_per_unit = 1;  // of the coordinates
  double baseline_mm = 0;  // disparity only: z = focal length * baseline / disparity
  double focal_length_px = 0;
  double aspect_ratio = 1;                        // vertical focal length by horizontal one
  double principal_u_px = 0, principal_v_px = 0;  // integers are pixel centres
  bool operator==(const Scan3d&) const = default;

  CameraIntrinsics camera(int width, int height) const;
};

// Nothing, or what cannot be used: the feature's name and its value, such as "Scan3dCoordinateScale
// of axis C is 0".
std::string scan3d_fault(const Scan3d& scan3d);
// The same question without a sentence, for use with every frame.
bool scan3d_usable(const Scan3d& scan3d);

}  // namespace binpick::drivers
