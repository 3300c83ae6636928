// Which poses of a part are the same pose: those that differ by a symmetry, or by a near symmetry
// that counts as one, and by little else. Poses are of the middle of the part's bounding box.
// Thread-safe: immutable.
#pragma once

#include <vector>

#include "binpick/model/part_symmetry.hpp"

namespace binpick::app {

class SamePose {
 public:
  SamePose(const PartSymmetry& symmetry, double diameter_mm, NearSymmetry near);

  double diameter_mm() const { return diameter_mm_; }
  // Axes that the part may rotate about by any angle and looks the same, in its own coordinates.
  struct Axis {
    Vec3 direction, point_mm;
  };
  const std::vector<Axis>& axes() const { return axes_; }
  bool ball() const { return ball_; }
  // What a pose may be followed by, without the rotations about the axes; the identity first.
  const std::vector<Pose>& transforms() const { return transforms_; }

  // The pose that looks like `pose` and is nearest to another.
  Pose nearest(const Pose& pose, const Pose& to) const {
    return nearest_of(pose, to, transforms_.size(), axes_.size());
  }
  // How far two poses are apart, in units of what is still the same pose: below 1 they are.
  double distance(const Pose& a, const Pose& b) const;
  // The same pose, but only by a near symmetry.
  bool flipped(const Pose& a, const Pose& b) const;

 private:
  Pose nearest_of(const Pose& pose, const Pose& to, std::size_t transforms, std::size_t axes) const;
  double plain_distance(const Pose& a, const Pose& b) const;
  void add_near(const Pose& transform);

  double diameter_mm_;
  std::vector<Pose> transforms_;  // those of the exact symmetries first
  std::vector<Axis> axes_;        // the exact ones first
  std::size_t exact_transforms_ = 0, exact_axes_ = 0;
  bool ball_ = false;
};

}  // namespace binpick::app
