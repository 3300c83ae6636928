#include "binpick/geometry/pose.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {

Mat3 rotation_from_vector(const Vec3& w_rad) {
  const double angle = w_rad.norm();
  Mat3 K;
  K << 0, -w_rad.z(), w_rad.y(), w_rad.z(), 0, -w_rad.x(), -w_rad.y(), w_rad.x(), 0;
  if (angle < 1e-9) return Mat3::Identity() + K;
  const double a = std::sin(angle) / angle;
  const double b = (1 - std::cos(angle)) / (angle * angle);
  return Mat3::Identity() + a * K + b * (K * K);
}

Vec3 rotation_vector(const Mat3& R) {
  const Eigen::AngleAxisd aa(R);
  return aa.axis() * aa.angle();
}

double rotation_angle_between(const Mat3& A, const Mat3& B) {
  const double c = ((A.transpose() * B).trace() - 1) / 2;
  return std::acos(std::clamp(c, -1.0, 1.0));
}

Mat3 orthonormalized(const Mat3& M) {
  Mat3 R;
  R.col(0) = M.col(0).normalized();
  R.col(1) = (M.col(1) - R.col(0).dot(M.col(1)) * R.col(0)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

Mat3 rotation_between(const Vec3& a, const Vec3& b) {
  const Vec3 v = a.cross(b);
  const double c = a.dot(b);
  if (c < -1 + 1e-12) {  // opposite: half a turn about any perpendicular axis
    const Vec3 p = (std::abs(a.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).cross(a).normalized();
    return 2 * p * p.transpose() - Mat3::Identity();
  }
  Mat3 K;
  K << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return Mat3::Identity() + K + K * K / (1 + c);
}

Pose left_increment(const Pose& T, const Vec3& w_rad, const Vec3& v_mm, const Vec3& pivot_mm) {
  const Mat3 dR = rotation_from_vector(w_rad);
  return {dR * T.R, dR * (T.t_mm - pivot_mm) + pivot_mm + v_mm};
}

}  // namespace binpick
