// Poses of made-up parts, as frames of a scene would give them.
#pragma once

#include <random>

#include "assess/observation.hpp"
#include "assess/same_pose.hpp"
#include "binpick/geometry/angle.hpp"
#include "core/symmetry_rows.hpp"

namespace binpick::app {

inline constexpr double kDiameter_mm = 40;

// A part with these symmetries, exact or near.
class MadeUpPart {
 public:
  std::vector<SymmetryTurn> exact_turns, near_turns;
  std::vector<SymmetryAxis> exact_axes, near_axes;

  SamePose same(NearSymmetry near = NearSymmetry::kAuto) const {
    return SamePose({exact_turns, near_turns, exact_axes, near_axes}, kDiameter_mm, near);
  }
};

inline Pose turned(const Pose& pose, const Vec3& axis, double angle_deg) {
  return pose * Pose{rotation_from_vector(angle_deg * kDegree * axis), Vec3::Zero()};
}

inline Observation observation(int frame, const Pose& pose, double score = 0.9) {
  Observation o;
  o.frame = frame;
  o.T_cam_centre = pose;
  o.score = score;
  return o;
}

// The pose with noise: a shift and a rotation about its centre, both in camera axes.
class PoseNoise {
 public:
  PoseNoise(const Vec3& sigma_mm, const Vec3& sigma_deg, unsigned seed = 5)
      : sigma_mm_(sigma_mm), sigma_deg_(sigma_deg), random_(seed) {}

  Pose operator()(const Pose& pose) {
    const auto draw = [this](const Vec3& sigma) -> Vec3 {
      return {sigma.x() * normal_(random_), sigma.y() * normal_(random_),
              sigma.z() * normal_(random_)};
    };
    return left_increment(pose, draw(sigma_deg_ * kDegree), draw(sigma_mm_), pose.t_mm);
  }

 private:
  Vec3 sigma_mm_, sigma_deg_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

// Some pose at a place.
inline Pose pose_at(double x_mm, double y_mm, double turn_deg = 0) {
  return {rotation_from_vector({0.4, -0.3, turn_deg * kDegree}), {x_mm, y_mm, 500}};
}

}  // namespace binpick::app
