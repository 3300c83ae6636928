#include "genicam/scan3d.hpp"

#include <cmath>
#include <cstdio>

namespace binpick::drivers {
namespace {

struct Fault {
  const char* feature;
  const char* axis;
  double value;
};

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

std::optional<Fault> fault_of_axis(const Scan3dAxis& axis, const char* name) {
  if (!std::isfinite(axis.scale) || axis.scale == 0)
    return Fault{"Scan3dCoordinateScale", name, axis.scale};
  if (!std::isfinite(axis.offset)) return Fault{"Scan3dCoordinateOffset", name, axis.offset};
  return std::nullopt;
}

// Wider than any lens and sensor, and narrow enough for products of such values.
constexpr double kPixelsMax = 1e6;

bool pixels(double value) {
  return std::abs(value) <= kPixelsMax;  // NaN is not
}

// The first value that cannot be used.
std::optional<Fault> find_fault(const Scan3d& s) {
  if (const auto fault = fault_of_axis(s.a, " of axis A")) return fault;
  if (const auto fault = fault_of_axis(s.b, " of axis B")) return fault;
  if (const auto fault = fault_of_axis(s.c, " of axis C")) return fault;
  if (!positive(s.mm_per_unit)) return Fault{"Scan3dDistanceUnit", " in mm", s.mm_per_unit};
  if (!pixels(s.focal_length_px) || s.focal_length_px < 1)
    return Fault{"Scan3dFocalLength", "", s.focal_length_px};
  if (!positive(s.aspect_ratio)) return Fault{"Scan3dAspectRatio", "", s.aspect_ratio};
  if (!pixels(s.principal_u_px)) return Fault{"Scan3dPrincipalPointU", "", s.principal_u_px};
  if (!pixels(s.principal_v_px)) return Fault{"Scan3dPrincipalPointV", "", s.principal_v_px};
  if (s.kind == DepthKind::kDisparity && !positive(s.baseline_mm))
    return Fault{"Scan3dBaseline", " in mm", s.baseline_mm};
  return std::nullopt;
}

}  // namespace

CameraIntrinsics Scan3d::camera(int width, int height) const {
  return {width,          height,        focal_length_px, focal_length_px * aspect_ratio,
          principal_u_px, principal_v_px};
}

std::string scan3d_fault(const Scan3d& scan3d) {
  const std::optional<Fault> fault = find_fault(scan3d);
  if (!fault) return "";
  char text[128];
  std::snprintf(text, sizeof text, "%s%s is %g", fault->feature, fault->axis, fault->value);
  return text;
}

bool scan3d_usable(const Scan3d& scan3d) {
  return !find_fault(scan3d);
}

}  // namespace binpick::drivers
