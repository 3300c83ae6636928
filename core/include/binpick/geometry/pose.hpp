// Rigid transforms. Lengths in mm, angles in rad. T_cam_obj maps object coordinates into camera
// coordinates: x_cam = T_cam_obj * x_obj. Camera axes: x right, y down, z along the view.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace binpick {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
// Unaligned on purpose: poses live in arena arrays and in std containers.
using Mat6 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;
using Vec6 = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;

struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 t_mm = Vec3::Zero();

  Vec3 operator*(const Vec3& x) const { return R * x + t_mm; }
  Pose operator*(const Pose& b) const { return {R * b.R, R * b.t_mm + t_mm}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * t_mm)}; }
};

// Rotation by the rotation vector w (axis times angle in rad); Rodrigues' formula.
Mat3 rotation_from_vector(const Vec3& w_rad);

// Rotation vector (rad) of R; its length is in [0, pi].
Vec3 rotation_vector(const Mat3& R);

// Angle in rad between two rotations.
double rotation_angle_between(const Mat3& A, const Mat3& B);

// The nearest rotation to M (Gram-Schmidt on the columns): removes drift of repeated products.
Mat3 orthonormalized(const Mat3& M);

// The smallest rotation that takes unit vector a to unit vector b.
Mat3 rotation_between(const Vec3& a, const Vec3& b);

// exp of a left increment (w, v): rotation vector first, translation second, about the camera's
// origin shifted to `pivot`: x -> exp(w) (x - pivot) + pivot + v.
Pose left_increment(const Pose& T, const Vec3& w_rad, const Vec3& v_mm, const Vec3& pivot_mm);

}  // namespace binpick
