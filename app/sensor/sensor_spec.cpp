#include "sensor/sensor_spec.hpp"

#include <cstdio>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/drivers/loaded_frame.hpp"
#include "config/config_file.hpp"
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

namespace {

struct Size {
  int width, height;
  std::string of;  // for messages
};

// The first frame of each scene of a recording, and what the camera file says.
std::vector<Size> announced_sizes(const SensorConfig& config) {
  std::vector<Size> sizes;
  const auto add = [&](const CameraIntrinsics& camera, const std::string& of) {
    sizes.push_back({camera.width, camera.height, of});
  };
  if (!config.camera_file.empty())
    add(drivers::load_camera_file(config.camera_file).intrinsics, config.camera_file);
  constexpr std::string_view kReplay = "replay:";
  if (!config.uri.starts_with(kReplay)) return sizes;
  try {
    const drivers::BopDataset recording(config.uri.substr(kReplay.size()), config.replay_split);
    for (const int id : recording.scene_ids()) {
      const drivers::BopScene scene = recording.scene(id);
      if (scene.frames.empty()) continue;
      add(recording.load_frame(scene, scene.frames.begin()->first).camera, scene.path);
    }
  } catch (const drivers::DatasetError&) {
  }
  return sizes;
}

}  // namespace

void check_frame_sizes(const Config& config) {
  std::vector<ConfigFault> faults;
  const auto check = [&](const char* key, int limit, int size, const Size& announced) {
    if (size <= limit) return;
    faults.push_back(fault_at(config.file, key,
                              "is " + std::to_string(limit) + ", but " + announced.of + " has " +
                                  std::to_string(announced.width) + "x" +
                                  std::to_string(announced.height) + " px"));
  };
  for (const Size& announced : announced_sizes(config.sensor)) {
    check("sensor.width_max", config.sensor.width_max, announced.width, announced);
    check("sensor.height_max", config.sensor.height_max, announced.height, announced);
    if (!faults.empty()) throw ConfigError(faults);
  }
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
