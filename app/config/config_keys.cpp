#include "config/config_keys.hpp"

namespace binpick::app {
namespace {

constexpr Reload kLive = Reload::kLive;
constexpr double kFar_mm = 100000;

template <class Enum>
void choose(KeyVisitor& visitor, const Key& key, Enum& value, std::span<const char* const> names) {
  int index = static_cast<int>(value);
  visitor.choice(key, index, names);
  value = static_cast<Enum>(index);
}

void visit_pose(const PoseKeys& keys, WrittenPose& pose, KeyVisitor& v) {
  constexpr Range<double> kPosition{-kFar_mm, kFar_mm}, kAngle{-360, 360};
  v.numbers({keys.position, kLive}, pose.position_mm, kPosition);
  v.numbers({keys.rotation, kLive}, pose.rotation_deg, kAngle);
  v.matrix({keys.wxyz, kLive}, pose.quaternion_wxyz, 1, 4);
  v.matrix({keys.xyzw, kLive}, pose.quaternion_xyzw, 1, 4);
  v.matrix({keys.matrix, kLive}, pose.matrix, 4, 4);
}

void visit_sensor(SensorConfig& c, KeyVisitor& v) {
  static constexpr const char* kTriggers[] = {"free_run", "software", "line"};
  v.text({"sensor.uri"}, c.uri);
  v.text({"sensor.profile"}, c.profile);
  choose(v, {"sensor.trigger"}, c.trigger, kTriggers);
  v.text({"sensor.trigger_line"}, c.trigger_line);
  v.text({"sensor.camera_file"}, c.camera_file);
  v.number({"sensor.exposure_us"}, c.exposure_us, {0, 1e7});
  v.number({"sensor.gain"}, c.gain, {-1, 1000});
  v.number({"sensor.frame_rate_hz"}, c.frame_rate_hz, {0, 1000});
  v.integer({"sensor.width_max"}, c.width_max, {16, 8192});
  v.integer({"sensor.height_max"}, c.height_max, {16, 8192});
  v.integer({"sensor.frame_deadline_ms"}, c.frame_deadline_ms, {10, 60000});
  v.integer({"sensor.reconnect_first_ms"}, c.reconnect_first_ms, {1, 60000});
  v.integer({"sensor.reconnect_max_ms"}, c.reconnect_max_ms, {1, 60000});
  v.integer({"sensor.buffers"}, c.buffers, {2, 32});
  v.integer({"sensor.packet_size_bytes"}, c.packet_size_bytes, {0, 16384});
  v.flag({"sensor.packet_socket"}, c.packet_socket);
  v.integer({"sensor.socket_buffer_bytes"}, c.socket_buffer_bytes, {0, 1 << 30});
  v.integer({"sensor.frame_retention_ms"}, c.frame_retention_ms, {1, 60000});
  v.text({"sensor.replay_split"}, c.replay_split);
  v.flag({"sensor.replay_loop"}, c.replay_loop);
  v.flag({"sensor.replay_paced"}, c.replay_paced);
}

void visit_station(StationConfig& c, KeyVisitor& v) {
  static constexpr const char* kRankings[] = {"score", "near_camera", "high_base"};
  static constexpr const char* kFrames[] = {"camera", "base"};
  static constexpr const char* kMountings[] = {"fixed", "flange"};
  v.texts({"station.recipes"}, c.recipes);
  v.integer({"station.recipe"}, c.recipe, {0, 65535});
  v.integer({"station.deadline_ms", kLive}, c.deadline_ms, {0, 60000});
  v.integer({"station.deadline_min_ms", kLive}, c.deadline_min_ms, {1, 60000});
  v.integer({"station.picks_max"}, c.picks_max, {1, 256});
  choose(v, {"station.ranking", kLive}, c.ranking, kRankings);
  choose(v, {"station.pose_frame", kLive}, c.pose_frame, kFrames);
  choose(v, {"station.mounting", kLive}, c.mounting, kMountings);
  visit_pose(kBaseCamKeys, c.T_base_cam, v);
  visit_pose(kFlangeCamKeys, c.T_flange_cam, v);
  v.flag({"station.fault_latched", kLive}, c.fault_latched);
  v.flag({"station.free_run"}, c.free_run);
  v.integer({"station.free_run_pause_ms", kLive}, c.free_run_pause_ms, {0, 3600000});
  v.text({"station.control_socket"}, c.control_socket);
}

// One of the register map's lists.
template <class Enum, std::size_t N>
void choose_named(KeyVisitor& visitor, const Key& key, Enum& value,
                  const modbus::map::NamedValue (&list)[N]) {
  const char* names[N];
  int index = 0;
  for (std::size_t i = 0; i < N; ++i) {
    names[i] = list[i].name;
    if (list[i].value == static_cast<std::uint16_t>(value)) index = static_cast<int>(i);
  }
  visitor.choice(key, index, names);
  value = static_cast<Enum>(list[index].value);
}

void visit_modbus(ModbusConfig& c, KeyVisitor& v) {
  namespace map = modbus::map;
  v.flag({"modbus.enabled"}, c.enabled);
  v.text({"modbus.bind"}, c.bind);
  v.integer({"modbus.port"}, c.port, {0, 65535});
  v.integer({"modbus.unit_id"}, c.unit_id, {0, 255});
  v.integer({"modbus.clients_max"}, c.clients_max, {1, 64});
  v.integer({"modbus.idle_timeout_ms"}, c.idle_timeout_ms, {0, 86400000});
  v.integer({"modbus.frame_timeout_ms"}, c.frame_timeout_ms, {10, 60000});
  v.texts({"modbus.allow"}, c.allow);
  v.text({"modbus.writer"}, c.writer);
  v.integer({"modbus.plc_heartbeat_timeout_ms"}, c.plc_heartbeat_timeout_ms, {0, 3600000});
  choose_named(v, {"modbus.word_order"}, c.encoding.word_order, map::kWordOrderNames);
  choose_named(v, {"modbus.rotation"}, c.encoding.rotation, map::kRotationConventionNames);
  choose_named(v, {"modbus.length_unit"}, c.encoding.length, map::kLengthUnitNames);
  choose_named(v, {"modbus.angle_unit"}, c.encoding.angle, map::kAngleUnitNames);
}

void visit_rest(Config& c, KeyVisitor& v) {
  static constexpr const char* kIsas[] = {"best", "scalar", "sse4", "avx2", "avx512"};
  static constexpr const char* kSchedulings[] = {"other", "fifo", "round_robin"};
  static constexpr const char* kModes[] = {"on_command", "on_fault", "always"};
  static constexpr const char* kLevels[] = {"error", "warning", "info", "debug"};
  v.integer({"memory.mib_max"}, c.memory.mib_max, {16, 1 << 20});
  v.flag({"memory.lock"}, c.memory.lock);
  v.flag({"memory.lock_required"}, c.memory.lock_required);
  v.integer({"threads.workers"}, c.threads.workers, {0, 256});
  choose(v, {"threads.isa"}, c.threads.isa, kIsas);
  v.integers({"threads.cpus"}, c.threads.cpus, {0, 1023});
  choose(v, {"threads.scheduling"}, c.threads.scheduling, kSchedulings);
  v.integer({"threads.priority"}, c.threads.priority, {0, 99});
  v.flag({"threads.required"}, c.threads.required);
  v.integer({"threads.stack_kib"}, c.threads.stack_kib, {256, 65536});
  choose(v, {"logging.level", kLive}, c.logging.level, kLevels);
  choose(v, {"recorder.mode", kLive}, c.recorder.mode, kModes);
  v.text({"recorder.folder"}, c.recorder.folder);
  v.integer({"recorder.cycles"}, c.recorder.cycles, {2, 64});
  v.integer({"recorder.mib_max"}, c.recorder.mib_max, {16, 1 << 24});
  v.integer({"recorder.free_mib_min"}, c.recorder.free_mib_min, {0, 1 << 24});
  v.text({"metrics.listen"}, c.metrics.listen);
}

}  // namespace

void visit_keys(Config& config, KeyVisitor& visitor) {
  visit_sensor(config.sensor, visitor);
  visit_station(config.station, visitor);
  visit_modbus(config.modbus, visitor);
  visit_rest(config, visitor);
}

void visit_keys(RecipeConfig& recipe, KeyVisitor& v) {
  v.integer({"number"}, recipe.number, {1, 65535});
  v.text({"name", kLive}, recipe.name);
  v.texts({"models"}, recipe.models);
  choose(v, {"modality", kLive}, recipe.modality, kModalityNames);
  choose(v, {"near_symmetry", kLive}, recipe.near_symmetry, kNearSymmetryNames);
  v.number({"min_score", kLive}, recipe.min_score, {0, 1});
  v.integer({"picks_max", kLive}, recipe.picks_max, {1, 256});
  v.numbers({"roi_px", Reload::kIfItFits}, recipe.roi_px, {0, 8192});
  visit_pose(kPickKeys, recipe.T_obj_pick, v);
}

}  // namespace binpick::app
