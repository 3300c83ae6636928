// The transforms of a part's symmetries, made ready for the cycle: no trigonometry where poses are
// compared by the million.
#pragma once

#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/base/arena_plan.hpp"
#include "binpick/model/object_model.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick {

// All of them act in the part's own coordinates (of the middle of its bounding box):
// T_cam_centre * transform shows the same part, or nearly.
class SymmetryTransforms {
 public:
  static void plan(const ObjectModel& model, ArenaPlan& plan);
  SymmetryTransforms() = default;
  SymmetryTransforms(const ObjectModel& model, Arena& arena);

  // Whether two poses differ by less than both limits, for the best of the part's exact symmetries.
  bool same(const Pose& a, const Pose& b, double position_mm, double rotation_rad) const;

  // The same, up to those of the near symmetries that are to count as well.
  bool looks_same(const Pose& a, const Pose& b, double position_mm, double rotation_rad,
                  NearSymmetry near) const;
  bool has_any(NearSymmetry near) const;

  // Of the poses that look the same, the one that shows the part as one of the model's viewpoints
  // does: a symmetric part has viewpoints on a part of the sphere only, and what is stored for them
  // holds for this pose.
  Pose canonical(const ObjectModel& model, const simd::PoseKernels& kernels,
                 const Pose& T_cam_centre) const;

  // What a pose may be taken for: the near-symmetric rotations, then angles about the near axes;
  // what an exact symmetry makes the same is listed once.
  std::span<const Pose> near_rotations() const { return near_.first(rotation_count_); }
  std::span<const Pose> near_angles() const { return near_.subspan(rotation_count_); }

  // How far an exact symmetry shifts the part's centre, at most.
  double centre_shift_max_mm() const { return reach_mm_; }

 private:
  Pose about_axis(const ObjectModel& model, const Pose& T_cam_centre, double& nearness) const;

  struct Axis {
    Vec3 direction = Vec3::Zero(), point_mm = Vec3::Zero();
    bool brings_together(const Pose& a, const Pose& b, double position_mm,
                         double rotation_rad) const;
  };

  std::span<Pose> exact_;  // without the identity
  std::span<Pose> near_;
  std::size_t rotation_count_ = 0;
  int axis_count_ = 0;  // 0, 1; 2: a ball
  Axis axis_;
  // As they are in the model, the indistinguishable ones first.
  struct NearMoves {
    std::span<Pose> rotations;
    std::span<Axis> axes;
  };
  NearMoves counting_as(NearSymmetry near) const;
  NearMoves all_near_;
  std::size_t indistinguishable_rotations_ = 0, indistinguishable_axes_ = 0;
  double reach_mm_ = 0;
};

}  // namespace binpick
