#include "aravis/sensor_setup.hpp"

#include <cstdio>

#include "aravis/gobject_ptr.hpp"
#include "binpick/drivers/camera.hpp"

namespace binpick::drivers {
namespace {

// Of an image that a frame can describe.
constexpr double kSideMax = 65535;

void check(const Features& features, const CaughtError& error, const char* what) {
  if (error) features.fail(std::string(what) + ": " + error.message());
}

void set_components(const Features& features, const SensorProfile& profile) {
  for (const ComponentSetting& component : profile.components) {
    CaughtError error;
    const bool there =
        arv_camera_is_enumeration_entry_available(features.camera(), "ComponentSelector",
                                                  component.name.c_str(), error.out()) != FALSE;
    if (!there && component.optional) continue;
    if (!there) features.fail("the feature ComponentSelector has no entry " + component.name);
    features.set("ComponentSelector", component.name);
    // A component that is always on may have no switch.
    if (features.has("ComponentEnable"))
      features.set("ComponentEnable", component.enable ? "true" : "false");
    if (component.enable && !component.pixel_format.empty())
      features.set("PixelFormat", component.pixel_format);
  }
}

void set_trigger(const Features& features, const CameraSpec& spec) {
  CaughtError error;
  if (features.has("AcquisitionMode")) {
    arv_camera_set_acquisition_mode(features.camera(), ARV_ACQUISITION_MODE_CONTINUOUS,
                                    error.out());
    check(features, error, "the feature AcquisitionMode cannot be set to Continuous");
  }
  if (spec.trigger == TriggerSource::kFreeRun) {
    if (!features.has("TriggerMode")) return;  // knows nothing but free run
    arv_camera_clear_triggers(features.camera(), error.out());
    check(features, error, "the feature TriggerMode cannot be set to Off");
    return;
  }
  const bool software = spec.trigger == TriggerSource::kSoftware;
  if (!features.has("TriggerMode")) features.fail("the sensor has no feature TriggerMode");
  if (software && !features.has("TriggerSoftware"))
    features.fail("the sensor has no feature TriggerSoftware");
  const std::string source = software ? "Software" : spec.trigger_line;
  arv_camera_set_trigger(features.camera(), source.c_str(), error.out());
  check(features, error, ("the feature TriggerSource cannot be set to " + source).c_str());
}

void set_exposure(const Features& features, const CameraSpec& spec) {
  CaughtError error;
  if (spec.exposure_us) features.set_number("ExposureTime", *spec.exposure_us);
  if (spec.gain) features.set_number("Gain", *spec.gain);
  if (spec.frame_rate_hz && spec.trigger == TriggerSource::kFreeRun) {
    arv_camera_set_frame_rate(features.camera(), *spec.frame_rate_hz, error.out());
    check(features, error, "the feature AcquisitionFrameRate cannot be set");
  }
}

void set_gige(const Features& features, const CameraSpec& spec) {
  ArvCamera* camera = features.camera();
  CaughtError error;
  // Multipart needs extended ids: with standard ids the part count collides with the packet id.
  if (features.has("GevGVSPExtendedIDMode")) features.set("GevGVSPExtendedIDMode", "On");
  if (arv_camera_gv_is_multipart_supported(camera, error.out()) != FALSE && !error) {
    arv_camera_gv_set_multipart(camera, TRUE, error.out());
    check(features, error, "multipart cannot be switched on");
  }
  if (!spec.packet_socket)
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  if (spec.packet_size_bytes > 0) {
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_packet_size(camera, spec.packet_size_bytes, error.out());
    check(features, error, "the packet size cannot be set");
  } else {
    arv_camera_gv_auto_packet_size(camera, error.out());
    check(features, error, "no packet size passes");
  }
}

// A side of an image; what comes from the wire may be anything.
int side_of(const Features& features, const char* name) {
  const double side = features.number(name);
  if (!(side >= 1 && side <= kSideMax)) {
    char text[64];
    std::snprintf(text, sizeof text, "the feature %s is %g, which cannot be used", name, side);
    features.fail(text);
  }
  return static_cast<int>(side);
}

bool has_component(const Features& features, const std::string& name) {
  CaughtError error;
  return features.has("ComponentSelector") &&
         arv_camera_is_enumeration_entry_available(features.camera(), "ComponentSelector",
                                                   name.c_str(), error.out()) != FALSE;
}

// On some sensors image size, pixel format and Scan3d values are those of the selected component:
// the one with the depth stays selected. The size of the largest image is noted on the way.
void select_depth(const Features& features, const SensorProfile& profile, SensorSetup& setup) {
  std::string depth;
  for (const ComponentSetting& component : profile.components) {
    if (!component.enable || !has_component(features, component.name)) continue;
    features.set("ComponentSelector", component.name);
    const int width = side_of(features, "Width"), height = side_of(features, "Height");
    if (width > setup.sensor_width) {
      setup.sensor_width = width;
      setup.sensor_height = height;
    }
    const bool named = component.name == "Range" || component.name == "Disparity";
    if (named || is_coord3d(pixel_format_from_name(component.pixel_format))) depth = component.name;
  }
  if (depth.empty()) {
    for (const char* name : {"Range", "Disparity"}) {
      if (depth.empty() && has_component(features, name)) depth = name;
    }
  }
  if (!depth.empty()) features.set("ComponentSelector", depth);
  setup.depth_width = side_of(features, "Width");
  setup.depth_height = side_of(features, "Height");
  if (setup.depth_width > setup.sensor_width) {
    setup.sensor_width = setup.depth_width;
    setup.sensor_height = setup.depth_height;
  }
}

PixelFormat selected_format(const Features& features) {
  if (!features.has("PixelFormat")) return PixelFormat::kUnknown;
  return pixel_format_from_name(features.text("PixelFormat"));
}

bool has_points(const SensorProfile& profile, PixelFormat selected) {
  const auto named = [](const std::string& name) {
    return is_coord3d_abc(pixel_format_from_name(name));
  };
  for (const ComponentSetting& component : profile.components) {
    if (component.enable && named(component.pixel_format)) return true;
  }
  return named(profile.pixel_format) || is_coord3d_abc(selected);
}

}  // namespace

SensorSetup set_up_sensor(const Features& features, const CameraSpec& spec) {
  const SensorProfile& profile = spec.profile;
  for (const FeatureSetting& s : profile.settings) features.set(s.name, s.value);
  for (const FeatureSetting& s : profile.optional_settings) {
    if (features.has(s.name)) features.set(s.name, s.value);
  }
  set_components(features, profile);
  if (!profile.pixel_format.empty()) features.set("PixelFormat", profile.pixel_format);
  set_trigger(features, spec);
  set_exposure(features, spec);
  if (arv_camera_is_gv_device(features.camera()) != FALSE) set_gige(features, spec);
  // The synchronous mode, Aravis' default, spins on a core once the sensor is unplugged.
  if (arv_camera_is_uv_device(features.camera()) != FALSE)
    arv_camera_uv_set_usb_mode(features.camera(), ARV_UV_USB_MODE_ASYNC);

  if (profile.chunks) features.set("ChunkModeActive", "true");  // the payload grows by them
  SensorSetup setup;
  select_depth(features, profile, setup);
  const PixelFormat format = selected_format(features);
  setup.with_points = has_points(profile, format);
  CaughtError error;
  setup.payload_bytes = arv_camera_get_payload(features.camera(), error.out());
  check(features, error, "the feature PayloadSize cannot be read");
  setup.depth_bytes =
      row_bytes(format, setup.depth_width) * static_cast<std::size_t>(setup.depth_height);
  return setup;
}

}  // namespace binpick::drivers
