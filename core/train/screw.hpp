// A rigid move as a turn about a line and a shift along it.
#pragma once

#include <cmath>

#include "binpick/geometry/pose.hpp"

namespace binpick::train {

struct Screw {
  Vec3 axis;      // unit
  Vec3 point_mm;  // of the line
  double angle_rad = 0, shift_mm = 0;
};

// The point is the line's nearest to the origin. `move` turns by more than nothing.
inline Screw screw_of(const Pose& move) {
  const Vec3 turn = rotation_vector(move.R);
  Screw s;
  s.angle_rad = turn.norm();
  s.axis = turn / s.angle_rad;
  s.shift_mm = s.axis.dot(move.t_mm);
  const Vec3 across = move.t_mm - s.shift_mm * s.axis;
  s.point_mm = (across + s.axis.cross(across) / std::tan(s.angle_rad / 2)) / 2;
  return s;
}

inline Pose pose_of(const Screw& s) {
  const Mat3 R = rotation_from_vector(s.axis * s.angle_rad);
  return {R, s.point_mm - R * s.point_mm + s.shift_mm * s.axis};
}

// The angle about a unit axis that comes nearest to the rotation R.
inline double angle_about(const Vec3& axis, const Mat3& R) {
  const Vec3 odd(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(axis.dot(odd), R.trace() - axis.dot(R * axis));
}

}  // namespace binpick::train
