// What a reload may change while the station runs: plain values, taken over between two cycles.
#pragma once

#include "config/config.hpp"
#include "station/recipe_set.hpp"

namespace binpick::app {

struct StationSettings {
  int deadline_ms = 0, deadline_min_ms = 0;
  Ranking ranking = Ranking::kScore;
  PoseFrame pose_frame = PoseFrame::kCamera;
  Mounting mounting = Mounting::kFixed;
  Pose T_base_cam, T_flange_cam;
  bool fault_latched = false;
  int free_run_pause_ms = 0;
  int frame_deadline_ms = 0;
};

// Whether commands that grab must carry the flange's pose.
inline bool needs_flange_pose(const StationConfig& c) {
  return c.pose_frame == PoseFrame::kBase && c.mounting == Mounting::kFlange;
}

inline StationSettings settings_of(const Config& config) {
  const StationConfig& c = config.station;
  return {c.deadline_ms,
          c.deadline_min_ms,
          c.ranking,
          c.pose_frame,
          c.mounting,
          pose_of(c.T_base_cam),
          pose_of(c.T_flange_cam),
          c.fault_latched,
          c.free_run_pause_ms,
          config.sensor.frame_deadline_ms};
}

}  // namespace binpick::app
