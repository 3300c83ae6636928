#include "cli/sensor_arguments.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "binpick/drivers/open_camera.hpp"
#include "binpick/drivers/sensor_list.hpp"
#include "cli/notes.hpp"
#include "cli/number_between.hpp"
#include "sensor/sensor_profile_file.hpp"

namespace binpick::app {

std::string sensor_profile_folder() {
  const char* folder = std::getenv("BINPICK_SENSOR_PROFILES");
  if (folder != nullptr) return folder;
  // Installed: PREFIX/bin and PREFIX/share. Else the program was built here.
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed = program.parent_path().parent_path() / "share/binpick/sensors";
  const bool there = !error && std::filesystem::is_directory(installed, error);
  return there ? installed.string() : BINPICK_SENSOR_PROFILE_FOLDER;
}

void add_sensor_options(CLI::App& command, SensorArguments& a) {
  command.add_option("--profile", a.profile, "Sensor profile (TOML) [the one that fits]");
  command.add_option("--camera", a.camera_file,
                     "Camera file with intrinsics to use instead of the sensor's own");
  command.add_option("--trigger", a.trigger, "What makes frames: software, line or free")
      ->check(CLI::IsMember({"software", "line", "free"}))
      ->capture_default_str();
  command.add_option("--line", a.line, "The line that triggers")->capture_default_str();
  command.add_option("--exposure-us", a.exposure_us, "Exposure time [as the sensor is set]")
      ->check(number_between(1.0, 1e8));
  command.add_option("--fps", a.fps, "Frame rate in free run [as the sensor is set]")
      ->check(number_between(0.01, 1000.0));
  command
      .add_option("--packet-size", a.packet_size, "GigE Vision packets [the largest that passes]")
      ->check(number_between(576, 65500));
  command.add_flag("--no-packet-socket", a.no_packet_socket,
                   "GigE Vision: receive by an ordinary socket even where more is allowed");
  command.add_flag("--loop", a.loop, "Recordings: begin anew at the end");
}

void tell_missing_features(const drivers::Camera& camera) {
  std::string names;
  for (const std::string& name : camera.missing_features())
    names += (names.empty() ? "" : ", ") + name;
  if (!names.empty()) std::fprintf(stderr, "binpick: the sensor has no %s\n", names.c_str());
}

void try_sensor(const drivers::CameraSpec& spec, FramePool& pool) {
  const auto camera = drivers::open_camera(spec);
  camera->start(pool);
  tell_missing_features(*camera);
}

Result<FrameRef> grab_within(SensorSession& session, double timeout_s) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(timeout_s));
  Result<FrameRef> frame = session.grab(deadline);
  while (!frame.ok() && frame.error().code != ErrorCode::kSensorEnd && Clock::now() < deadline)
    frame = session.grab(deadline);
  return frame;
}

drivers::CameraSpec camera_spec_of(const SensorArguments& a) {
  drivers::CameraSpec spec;
  spec.uri = a.uri;
  if (a.trigger == "free") spec.trigger = drivers::TriggerSource::kFreeRun;
  if (a.trigger == "line") spec.trigger = drivers::TriggerSource::kLine;
  spec.trigger_line = a.line;
  if (a.exposure_us > 0) spec.exposure_us = a.exposure_us;
  if (a.fps > 0) spec.frame_rate_hz = a.fps;
  spec.packet_size_bytes = a.packet_size;
  spec.packet_socket = !a.no_packet_socket;
  spec.loop = a.loop;
  if (!a.camera_file.empty()) {
    const drivers::FrameCamera camera = drivers::load_sensor_camera_file(a.camera_file);
    print_notes(camera.notes);
    spec.intrinsics = camera.intrinsics;
  }
  if (!a.profile.empty()) {
    spec.profile = load_sensor_profile(a.profile);
    return spec;
  }
  if (!drivers::is_live_sensor(a.uri)) return spec;
  const drivers::SensorReport sensor = drivers::read_sensor_report(a.uri);
  const auto profiles = load_sensor_profiles(sensor_profile_folder());
  if (const auto* fitting = find_profile(profiles, sensor.vendor, sensor.model))
    spec.profile = *fitting;
  std::fprintf(stderr, "binpick: %s %s, profile %s\n", sensor.vendor.c_str(), sensor.model.c_str(),
               spec.profile.name.c_str());
  return spec;
}

}  // namespace binpick::app
