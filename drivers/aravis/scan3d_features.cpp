#include "aravis/scan3d_features.hpp"

#include <cmath>

#include "aravis/gobject_ptr.hpp"

namespace binpick::drivers {
namespace {

// From the entries that the naming convention gives Scan3dDistanceUnit, and those seen in the
// field.
double mm_per_unit_of(const Features& features, const SensorProfile& profile) {
  if (profile.mm_per_unit > 0) return profile.mm_per_unit;
  const std::string unit = features.text("Scan3dDistanceUnit");
  if (unit == "Millimeter") return 1;
  if (unit == "Meter") return 1000;
  if (unit == "Inch") return 25.4;
  features.fail("the feature Scan3dDistanceUnit is " + unit +
                ", which is no unit of length; the sensor's profile has to give mm_per_unit");
}

DepthKind depth_kind_of(const Features& features, const SensorProfile& profile) {
  if (profile.depth == DepthMeaning::kZ) return DepthKind::kZ;
  if (profile.depth == DepthMeaning::kDisparity) return DepthKind::kDisparity;
  const std::string mode = features.text("Scan3dOutputMode");
  if (mode == "DisparityC") return DepthKind::kDisparity;
  for (const char* metric : {"CalibratedABC_Grid", "CalibratedC", "RectifiedC", "ProjectedC"}) {
    if (mode == metric) return DepthKind::kZ;
  }
  features.fail("the feature Scan3dOutputMode is " + mode +
                ", which is no image of distances or disparities");
}

Scan3dAxis read_axis(const Features& features, const SensorProfile& profile, const char* name) {
  const bool all_known = profile.scale.value && profile.offset.value &&
                         profile.invalid_flag.value &&
                         (*profile.invalid_flag.value == 0 || profile.invalid_value.value);
  if (!all_known) features.set("Scan3dCoordinateSelector", std::string("Coordinate") + name);
  Scan3dAxis axis;
  axis.scale = features.number(profile.scale);
  axis.offset = features.number(profile.offset);
  if (features.number(profile.invalid_flag) != 0) {
    const double invalid = features.number(profile.invalid_value);
    // NaN is no measurement anyway.
    if (!std::isnan(invalid)) axis.invalid_code = invalid;
  }
  return axis;
}

}  // namespace

Scan3d read_scan3d(const Features& features, const CameraSpec& spec, bool with_points) {
  const SensorProfile& profile = spec.profile;
  Scan3d s;
  s.kind = depth_kind_of(features, profile);
  if (with_points) {
    s.a = read_axis(features, profile, "A");
    s.b = read_axis(features, profile, "B");
  }
  s.c = read_axis(features, profile, "C");
  if (s.kind == DepthKind::kZ) {
    s.mm_per_unit = mm_per_unit_of(features, profile);
  } else {
    const double unit_mm =
        profile.baseline_unit_mm > 0 ? profile.baseline_unit_mm : mm_per_unit_of(features, profile);
    s.baseline_mm = features.number(profile.baseline) * unit_mm;
  }
  if (spec.intrinsics) {
    s.focal_length_px = spec.intrinsics->fx;
    s.aspect_ratio = spec.intrinsics->fy / spec.intrinsics->fx;
    s.principal_u_px = spec.intrinsics->cx;
    s.principal_v_px = spec.intrinsics->cy;
  } else {
    s.focal_length_px = features.number(profile.focal_length);
    // Few sensors have it: pixels are square unless it says otherwise.
    const FeatureOrValue& aspect = profile.aspect_ratio;
    if (aspect.value || features.has(aspect.feature)) s.aspect_ratio = features.number(aspect);
    s.principal_u_px = features.number(profile.principal_u) + profile.principal_point_shift_px;
    s.principal_v_px = features.number(profile.principal_v) + profile.principal_point_shift_px;
  }
  const std::string fault = scan3d_fault(s);
  if (!fault.empty()) features.fail("the feature " + fault + ", which cannot be used");
  return s;
}

Scan3dChunks::Scan3dChunks(const Features& features, const CameraSpec& spec)
    : shift_px_(spec.profile.principal_point_shift_px),
      fixed_intrinsics_(spec.intrinsics.has_value()) {
  if (!spec.profile.chunks) return;
  features.set("ChunkModeActive", "true");
  // One chunk with all values on some sensors, one a value on others: what exists is enabled.
  for (const char* chunk :
       {"Scan3dFocalLength", "Scan3dBaseline", "Scan3dPrincipalPointU", "Scan3dPrincipalPointV"}) {
    CaughtError error;
    if (arv_camera_is_enumeration_entry_available(features.camera(), "ChunkSelector", chunk,
                                                  error.out()) == FALSE)
      continue;
    features.set("ChunkSelector", chunk);
    features.set("ChunkEnable", "true");
  }
  ArvDevice* device = arv_camera_get_device(features.camera());
  const auto known = [&](const char* name) {
    return arv_device_get_feature(device, name) != nullptr;
  };
  has_focal_length_ = known("ChunkScan3dFocalLength");
  has_baseline_ = known("ChunkScan3dBaseline");
  has_principal_point_ = known("ChunkScan3dPrincipalPointU") && known("ChunkScan3dPrincipalPointV");
  if (!has_focal_length_) features.fail("the sensor has no chunk ChunkScan3dFocalLength");
  if (spec.profile.baseline_unit_mm > 0) {
    baseline_unit_mm_ = spec.profile.baseline_unit_mm;
  } else if (has_baseline_) {
    baseline_unit_mm_ = mm_per_unit_of(features, spec.profile);
  }
  parser_ = arv_camera_create_chunk_parser(features.camera());
}

Scan3dChunks::~Scan3dChunks() {
  if (parser_ != nullptr) g_object_unref(parser_);
}

bool Scan3dChunks::read(ArvBuffer* buffer, const char* chunk, double& value) const {
  CaughtError error;
  value = arv_chunk_parser_get_float_value(parser_, buffer, chunk, error.out());
  return !error;
}

bool Scan3dChunks::apply(ArvBuffer* buffer, Scan3d& s) const {
  if (arv_buffer_has_chunks(buffer) == FALSE) return false;
  double value = 0;
  if (has_baseline_ && s.kind == DepthKind::kDisparity) {
    if (!read(buffer, "ChunkScan3dBaseline", value)) return false;
    s.baseline_mm = value * baseline_unit_mm_;
  }
  if (!fixed_intrinsics_) {
    if (!read(buffer, "ChunkScan3dFocalLength", s.focal_length_px)) return false;
    if (has_principal_point_) {
      if (!read(buffer, "ChunkScan3dPrincipalPointU", value)) return false;
      s.principal_u_px = value + shift_px_;
      if (!read(buffer, "ChunkScan3dPrincipalPointV", value)) return false;
      s.principal_v_px = value + shift_px_;
    }
  }
  return scan3d_usable(s);
}

}  // namespace binpick::drivers
