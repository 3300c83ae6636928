#include "aravis/missing_features.hpp"

#include <algorithm>

#include "aravis/gobject_ptr.hpp"

namespace binpick::drivers {
namespace {

// By the GenICam Standard Features Naming Convention.
constexpr const char* kUsual[] = {"AcquisitionMode",
                                  "AcquisitionFrameRate",
                                  "TriggerMode",
                                  "TriggerSource",
                                  "TriggerSoftware",
                                  "ExposureTime",
                                  "Gain",
                                  "ChunkModeActive",
                                  "PixelFormat",
                                  "Scan3dOutputMode",
                                  "Scan3dDistanceUnit",
                                  "Scan3dCoordinateSelector"};

}  // namespace

std::vector<std::string> missing_features(const Features& features, const CameraSpec& spec) {
  const SensorProfile& p = spec.profile;
  std::vector<std::string> names(std::begin(kUsual), std::end(kUsual));
  for (const FeatureOrValue* source :
       {&p.scale, &p.offset, &p.invalid_flag, &p.invalid_value, &p.focal_length, &p.aspect_ratio,
        &p.principal_u, &p.principal_v, &p.baseline}) {
    if (!source->value) names.push_back(source->feature);
  }
  for (const FeatureSetting& setting : p.optional_settings) names.push_back(setting.name);
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    const bool listed = std::find(missing.begin(), missing.end(), name) != missing.end();
    if (!listed && !features.has(name)) missing.push_back(name);
  }
  for (const ComponentSetting& component : p.components) {
    CaughtError error;
    if (component.enable && component.optional &&
        arv_camera_is_enumeration_entry_available(features.camera(), "ComponentSelector",
                                                  component.name.c_str(), error.out()) == FALSE)
      missing.push_back("ComponentSelector " + component.name);
  }
  return missing;
}

}  // namespace binpick::drivers
