// The one list of the configuration's keys. Whoever reads, checks, documents or compares a
// configuration visits it. Set-up only.
#pragma once

#include <limits>
#include <span>

#include "config/config.hpp"

namespace binpick::app {

// What it takes for a changed value to have an effect.
enum class Reload {
  kLive,
  kIfItFits,  // live where the memory taken at start suffices
  kRestart,
};

struct Key {
  const char* path;  // "station.deadline_ms"
  Reload reload = Reload::kRestart;
};

template <class T>
struct Range {
  T min = std::numeric_limits<T>::lowest(), max = std::numeric_limits<T>::max();
};

class KeyVisitor {
 public:
  virtual ~KeyVisitor() = default;
  virtual void flag(const Key& key, bool& value) = 0;
  virtual void integer(const Key& key, int& value, Range<int> range) = 0;
  virtual void number(const Key& key, double& value, Range<double> range) = 0;
  virtual void text(const Key& key, std::string& value) = 0;
  // `value` is an index into names.
  virtual void choice(const Key& key, int& value, std::span<const char* const> names) = 0;
  // Exactly as many as there are.
  virtual void numbers(const Key& key, std::span<double> values, Range<double> range) = 0;
  virtual void integers(const Key& key, std::vector<int>& values, Range<int> range) = 0;
  // None, or rows x columns: a list of lists where there is more than one row.
  virtual void matrix(const Key& key, std::vector<double>& values, std::size_t rows,
                      std::size_t columns) = 0;
  virtual void texts(const Key& key, std::vector<std::string>& values) = 0;
};

// The keys of one transform.
struct PoseKeys {
  const char *position, *rotation, *wxyz, *xyzw, *matrix;
};
inline constexpr PoseKeys kBaseCamKeys = {
    "station.T_base_cam_position_mm", "station.T_base_cam_rotation_deg",
    "station.T_base_cam_quaternion_wxyz", "station.T_base_cam_quaternion_xyzw",
    "station.T_base_cam_matrix"};
inline constexpr PoseKeys kFlangeCamKeys = {
    "station.T_flange_cam_position_mm", "station.T_flange_cam_rotation_deg",
    "station.T_flange_cam_quaternion_wxyz", "station.T_flange_cam_quaternion_xyzw",
    "station.T_flange_cam_matrix"};
inline constexpr PoseKeys kPickKeys = {"T_obj_pick_position_mm", "T_obj_pick_rotation_deg",
                                       "T_obj_pick_quaternion_wxyz", "T_obj_pick_quaternion_xyzw",
                                       "T_obj_pick_matrix"};

// Of the main file; not of its recipes.
void visit_keys(Config& config, KeyVisitor& visitor);
// Of one recipe file.
void visit_keys(RecipeConfig& recipe, KeyVisitor& visitor);

}  // namespace binpick::app
