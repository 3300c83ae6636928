// The moves of a part's symmetries, made ready for the cycle: no trigonometry where poses are
// compared by the million.
#pragma once

#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/base/arena_plan.hpp"
#include "binpick/model/object_model.hpp"

namespace binpick {

// All of them move the part within its own coordinates (of the middle of its bounding box):
// T_cam_centre * move shows the same part, or nearly.
class PartMoves {
 public:
  static void plan(const ObjectModel& model, ArenaPlan& plan);
  PartMoves() = default;
  PartMoves(const ObjectModel& model, Arena& arena);

  // Whether two poses differ by less than both limits, for the best of the part's exact symmetries.
  bool same(const Pose& a, const Pose& b, double position_mm, double rotation_rad) const;

  // Of the poses that look the same, the one that shows the part as one of the model's viewpoints
  // does: a symmetric part has viewpoints on a part of the sphere only, and what is stored for them
  // holds for this pose.
  Pose canonical(const ObjectModel& model, const Pose& T_cam_centre) const;

  // What a pose may be taken for: the near turns, then the steps of a turn about the near axes;
  // what an exact symmetry makes the same is listed once.
  std::span<const Pose> near_turns() const { return near_.first(turn_count_); }
  std::span<const Pose> near_steps() const { return near_.subspan(turn_count_); }

 private:
  Pose about_axis(const ObjectModel& model, const Pose& T, double& nearness) const;
  bool same_about_axis(const Pose& a, const Pose& b, double position_mm, double rotation_rad) const;

  std::span<Pose> exact_;  // without the identity
  std::span<Pose> near_;
  std::size_t turn_count_ = 0;
  int axis_count_ = 0;  // 0, 1; 2: a ball
  Vec3 axis_ = Vec3::Zero(), point_mm_ = Vec3::Zero();
  double reach_mm_ = 0;  // how far an exact move shifts the origin, at most
};

}  // namespace binpick
