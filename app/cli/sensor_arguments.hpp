// The options that say which sensor and how: shared by the commands that open one.
#pragma once

#include <memory>
#include <string>

#include "binpick/drivers/camera.hpp"
#include "binpick/drivers/camera_spec.hpp"
#include "sensor/sensor_session.hpp"

namespace CLI {
class App;
}

namespace binpick::app {

struct SensorArguments {
  std::string uri, profile, camera_file, trigger = "software", line = "Line0";
  double exposure_us = 0, fps = 0;
  int packet_size = 0, width_max = 2048, height_max = 2048;
  bool no_packet_socket = false, loop = false;
};

void add_sensor_options(CLI::App& command, SensorArguments& arguments);

// Asks the sensor who it is and takes the profile that fits, unless one is named; says on stderr
// which. Throws what is wrong with the URI, the profile or the camera file.
drivers::CameraSpec camera_spec_of(const SensorArguments& arguments);

// Where the profiles are that came with this build.
std::string sensor_profile_folder();

// Opens the sensor and lets it go again: what is wrong with it or its settings is told at once, in
// a SensorError, and not only when a frame fails to come.
void try_sensor(const drivers::CameraSpec& spec, FramePool& pool);

// The next frame. A lost sensor is opened again until the time for a frame is over.
Result<FrameRef> grab_within(SensorSession& session, double timeout_s);

// One line on stderr with what the sensor lacks; nothing where it lacks nothing.
void tell_missing_features(const drivers::Camera& camera);

}  // namespace binpick::app
