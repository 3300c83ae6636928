#include "sensor/sensor_spec.hpp"

#include <cstdio>

#include "binpick/drivers/loaded_frame.hpp"
#include "sensor/sensor_profile_file.hpp"

namespace binpick::app {

drivers::CameraSpec camera_spec_of(const SensorConfig& config) {
  drivers::CameraSpec spec;
  spec.uri = config.uri;
  if (!config.profile.empty()) spec.profile = load_sensor_profile(config.profile);
  spec.trigger = config.trigger;
  spec.trigger_line = config.trigger_line;
  if (config.exposure_us > 0) spec.exposure_us = config.exposure_us;
  if (config.gain >= 0) spec.gain = config.gain;
  if (config.frame_rate_hz > 0) spec.frame_rate_hz = config.frame_rate_hz;
  if (!config.camera_file.empty()) {
    const drivers::FrameCamera camera = drivers::load_sensor_camera_file(config.camera_file);
    for (const std::string& note : camera.notes)
      std::fprintf(stderr, "binpickd: %s\n", note.c_str());
    spec.intrinsics = camera.intrinsics;
  }
  spec.buffer_count = config.buffers;
  spec.packet_size_bytes = config.packet_size_bytes;
  spec.packet_socket = config.packet_socket;
  spec.socket_buffer_bytes = config.socket_buffer_bytes;
  spec.frame_retention_ms = config.frame_retention_ms;
  spec.loop = config.replay_loop;
  spec.paced = config.replay_paced;
  spec.split = config.replay_split;
  return spec;
}

SessionParams session_params_of(const SensorConfig& config) {
  SessionParams params;
  params.trigger = config.trigger;
  params.frame_deadline = std::chrono::milliseconds(config.frame_deadline_ms);
  params.backoff_first = std::chrono::milliseconds(config.reconnect_first_ms);
  params.backoff_max = std::chrono::milliseconds(config.reconnect_max_ms);
  return params;
}

bool is_simulated(const SensorConfig& config) {
  return config.uri.starts_with("replay:") || config.uri.starts_with("sim:");
}

}  // namespace binpick::app
