#include "binpick/model/part_symmetry.hpp"

namespace binpick {
namespace {

Pose screw(const Vec3& axis, const Vec3& point_mm, double angle_rad, double shift_mm) {
  const Mat3 R = rotation_from_vector(axis * angle_rad);
  return {R, point_mm - R * point_mm + shift_mm * axis};
}

}  // namespace

Vec3 vector_of(const float (&v)[3]) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Pose move_of(const SymmetryTurn& t) {
  return screw(vector_of(t.axis), vector_of(t.point_mm), static_cast<double>(t.angle_rad),
               static_cast<double>(t.shift_mm));
}

Pose move_about(const SymmetryAxis& a, double angle_rad) {
  return screw(vector_of(a.axis), vector_of(a.point_mm), angle_rad, 0);
}

Pose in_cad(const Pose& move, const Vec3& centre_mm) {
  return {move.R, move.t_mm + centre_mm - move.R * centre_mm};
}

}  // namespace binpick
