// From the configuration's words to what drivers and the session are opened with. Set-up only.
#pragma once

#include "config/config.hpp"
#include "sensor/sensor_session.hpp"

namespace binpick::app {

// Reads sensor.profile and sensor.camera_file where they are set: throws SetupError and
// drivers::DatasetError.
drivers::CameraSpec camera_spec_of(const SensorConfig& config);
// The frames of a recording, and the image of sensor.camera_file, have to fit into what memory is
// taken for: throws ConfigError that names the key. A recording that cannot be read is left to
// whoever opens it.
void check_frame_sizes(const Config& config);
SessionParams session_params_of(const SensorConfig& config);
// Frames come from a recording or a double: nothing in them is to be picked.
bool is_simulated(const SensorConfig& config);

}  // namespace binpick::app
