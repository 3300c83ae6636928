// Everything that a station is told in its configuration files, as plain values, one struct a part
// of the program. Defaults, units and ranges: config_keys.cpp lists each key once, and
// firmware-config/binpick.toml describes each for the person who sets it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "binpick/drivers/camera_spec.hpp"
#include "binpick/frame/frame.hpp"
#include "binpick/simd/isa.hpp"
#include "log/log_level.hpp"
#include "modbus/encoding.hpp"
#include "recorder/record_mode.hpp"

namespace binpick::app {

struct SensorConfig {
  std::string uri;      // must be set
  std::string profile;  // file; empty: the names of GenICam's standard
  drivers::TriggerSource trigger = drivers::TriggerSource::kSoftware;
  std::string trigger_line = "Line0";
  std::string camera_file;  // intrinsics instead of the sensor's own; empty: the sensor's
  double exposure_us = 0;   // 0: as the sensor is set
  double gain = -1;         // -1: as the sensor is set
  double frame_rate_hz = 0;
  int width_max = 1280, height_max = 1024;  // px of the largest frame; sizes all memory
  int frame_deadline_ms = 900;
  int reconnect_first_ms = 50, reconnect_max_ms = 400;
  int buffers = 4;
  int packet_size_bytes = 0;
  bool packet_socket = true;
  int socket_buffer_bytes = 0;
  int frame_retention_ms = 200;
  std::string replay_split = "test";
  bool replay_loop = true;
  bool replay_paced = false;
};

enum class Ranking : int { kScore = 0, kNearCamera, kHighBase };
enum class PoseFrame : int { kCamera = 0, kBase };
enum class Mounting : int { kFixed = 0, kFlange };

// A rigid transform as people write it: a position and a rotation in one of three ways, or a matrix
// for both. What is not used is empty. RecipeSet's pose_of() reads it.
struct WrittenPose {
  std::array<double, 3> position_mm{};
  std::array<double, 3> rotation_deg{};  // about the fixed x, then y, then z axis
  std::vector<double> quaternion_wxyz{}, quaternion_xyzw{};
  std::vector<double> matrix{};  // 4x4, row by row
};

struct StationConfig {
  std::vector<std::string> recipes;  // files, relative to the configuration's folder
  int recipe = 0;                    // number at start; 0: the first file's
  int deadline_ms = 0;               // of a cycle whose command gives none; 0: none
  int deadline_min_ms = 1;           // shorter ones are refused
  int picks_max = 64;                // of any cycle; sizes memory
  Ranking ranking = Ranking::kScore;
  PoseFrame pose_frame = PoseFrame::kCamera;
  Mounting mounting = Mounting::kFixed;
  WrittenPose T_base_cam, T_flange_cam;
  bool fault_latched = false;
  bool free_run = false;
  int free_run_pause_ms = 0;
  std::string control_socket = "/run/binpick/control";  // empty: none
};

struct ModbusConfig {
  bool enabled = true;
  std::string bind = "0.0.0.0";
  int port = 502;
  int unit_id = 1;
  int clients_max = 16;
  int idle_timeout_ms = 60000;
  int frame_timeout_ms = 1000;
  std::vector<std::string> allow;  // addresses and networks; empty: everybody
  std::string writer;              // the one address that may write; empty: whoever connects
  int plc_heartbeat_timeout_ms = 2000;
  modbus::Encoding encoding;
};

struct MemoryConfig {
  int mib_max = 2048;
  bool lock = true;
  bool lock_required = true;  // false: a station that may not lock runs without
};

enum class Scheduling : int { kOther = 0, kFifo, kRoundRobin };

struct ThreadsConfig {
  int workers = 0;  // 0: every processor that the process may use
  Isa isa = Isa::kBest;
  std::vector<int> cpus;  // of the cycle and its workers; empty: any
  Scheduling scheduling = Scheduling::kOther;
  int priority = 0;
  bool required = false;  // true: a station that may not set cpus and scheduling does not start
  int stack_kib = 1024;
};

struct LoggingConfig {
  LogLevel level = LogLevel::kInfo;
};

struct RecorderConfig {
  std::string folder;  // empty: no recorder
  RecordMode mode = RecordMode::kOnFault;
  int cycles = 8;  // kept in memory; sizes memory
  int mib_max = 4096;
  int free_mib_min = 1024;
};

struct MetricsConfig {
  std::string listen;  // empty: none
};

// What is to be picked: one file each.
struct RecipeConfig {
  std::string file;                 // where it was read
  int number = 0;                   // 1 .. 65535; how the PLC names it
  std::string name;                 // for people
  std::vector<std::string> models;  // files, relative to the recipe's folder; all are looked for
  Modality modality = Modality::kAutomatic;
  NearSymmetry near_symmetry = NearSymmetry::kAuto;
  double min_score = DetectRequest{}.min_score;
  int picks_max = 16;
  std::array<double, 4> roi_px{};  // x, y, width, height; zeros: the frame's own
  WrittenPose T_obj_pick;
};

struct Config {
  std::string file;
  SensorConfig sensor;
  StationConfig station;
  ModbusConfig modbus;
  MemoryConfig memory;
  ThreadsConfig threads;
  LoggingConfig logging;
  RecorderConfig recorder;
  MetricsConfig metrics;
  std::vector<RecipeConfig> recipes;  // read from station.recipes, in that order
};

}  // namespace binpick::app
