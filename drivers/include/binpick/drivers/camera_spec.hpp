// What a sensor is opened with, as plain values: who asks for it (the command line, a daemon's
// configuration) reads files; drivers do not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "binpick/geometry/camera_model.hpp"

namespace binpick::drivers {

// A number that a feature of the sensor gives, or that is known beforehand.
struct FeatureOrValue {
  std::string feature;
  std::optional<double> value;  // set: the feature is not asked
};

struct FeatureSetting {
  std::string name, value;
};

// One of the images that a multipart sensor can send.
struct ComponentSetting {
  std::string name;  // entry of ComponentSelector
  bool enable = true;
  bool optional = false;     // a sensor that lacks it is served without
  std::string pixel_format;  // empty: as it is
};

enum class DepthMeaning { kFromOutputMode, kZ, kDisparity };

// How a kind of sensor is set up and read; the defaults are the names of the GenICam Standard
// Features Naming Convention.
struct SensorProfile {
  std::string name = "generic-genicam-3d";
  // It fits sensors whose vendor and model begin so; empty: any.
  std::string vendor, model;

  std::vector<FeatureSetting> settings;           // applied first, in this order
  std::vector<FeatureSetting> optional_settings;  // where the sensor has the feature
  std::vector<ComponentSetting> components;
  std::string pixel_format;  // single image; empty: as it is

  DepthMeaning depth = DepthMeaning::kFromOutputMode;
  bool mono16_is_depth = false;  // of a single image
  double mm_per_unit = 0;        // 0: by Scan3dDistanceUnit
  double baseline_unit_mm = 0;   // 0: the same unit
  // Added to the principal point: -0.5 where the sensor's origin is a pixel's corner.
  double principal_point_shift_px = 0;
  double confidence_min = 0;  // share of full confidence
  bool chunks = false;        // frames carry Scan3d values, which replace those read at start

  FeatureOrValue scale{"Scan3dCoordinateScale", {}}, offset{"Scan3dCoordinateOffset", {}};
  FeatureOrValue invalid_flag{"Scan3dInvalidDataFlag", {}};
  FeatureOrValue invalid_value{"Scan3dInvalidDataValue", {}};
  FeatureOrValue focal_length{"Scan3dFocalLength", {}}, baseline{"Scan3dBaseline", {}};
  FeatureOrValue aspect_ratio{"Scan3dAspectRatio", {}};  // optional: 1 where there is none
  FeatureOrValue principal_u{"Scan3dPrincipalPointU", {}};
  FeatureOrValue principal_v{"Scan3dPrincipalPointV", {}};
};

enum class TriggerSource { kFreeRun, kSoftware, kLine };

struct CameraSpec {
  // gev://ADDRESS, gev://serial/NUMBER, u3v://serial/NUMBER, replay:DIR
  std::string uri;
  SensorProfile profile;
  TriggerSource trigger = TriggerSource::kSoftware;
  std::string trigger_line = "Line0";
  // Free run: of several frames that wait the newest is given. Else each, in their order.
  bool newest_wins = true;
  std::optional<double> exposure_us, gain, frame_rate_hz;
  // Instead of the sensor's own focal length and principal point.
  std::optional<CameraIntrinsics> intrinsics;
  int buffer_count = 4;  // of the driver: one filling, one waiting, two for bursts

  // GigE Vision
  int packet_size_bytes = 0;     // 0: the largest that passes
  bool packet_socket = true;     // used where the process may; a firewall does not see it
  int socket_buffer_bytes = 0;   // 0: one frame
  int frame_retention_ms = 200;  // a frame that stalls for so long is given up

  // Recordings
  bool loop = false;
  bool paced = true;  // by the recording's times; else as fast as asked for
  std::string split = "test";
};

}  // namespace binpick::drivers
