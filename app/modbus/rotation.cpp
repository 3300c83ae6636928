#include "modbus/rotation.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/base/assert.hpp"

namespace binpick::modbus {
namespace {

using map::RotationConvention;

// Below this distance from a pole (as sine of the angle to it) the first and third axes coincide.
constexpr double kPoleSine = 1e-9;

struct Axes {
  int i, j, k;
};

Axes axes_of(RotationConvention convention) {
  switch (convention) {
    case RotationConvention::kEulerXyz:
      return {0, 1, 2};
    case RotationConvention::kEulerXzy:
      return {0, 2, 1};
    case RotationConvention::kEulerYxz:
      return {1, 0, 2};
    case RotationConvention::kEulerYzx:
      return {1, 2, 0};
    case RotationConvention::kEulerZxy:
      return {2, 0, 1};
    case RotationConvention::kEulerXyx:
      return {0, 1, 0};
    case RotationConvention::kEulerXzx:
      return {0, 2, 0};
    case RotationConvention::kEulerYxy:
      return {1, 0, 1};
    case RotationConvention::kEulerYzy:
      return {1, 2, 1};
    case RotationConvention::kEulerZxz:
      return {2, 0, 2};
    case RotationConvention::kEulerZyz:
      return {2, 1, 2};
    default:  // KUKA, FANUC and Euler zyx: the same turns
      return {2, 1, 0};
  }
}

// +1 when j follows i in x, y, z, x, ...
double parity(int i, int j) {
  return (i + 1) % 3 == j ? 1.0 : -1.0;
}

// R = Ri(a) Rj(b) Rk(c) with three axes: R(i,k) = e sin b, and the elements beside it in row i and
// column k are cos b times sines and cosines of c and a.
std::array<double, 3> three_axes(const Mat3& R, Axes x) {
  const double e = parity(x.i, x.j);
  const double cosine = std::hypot(R(x.j, x.k), R(x.k, x.k));
  const double b = std::atan2(e * R(x.i, x.k), cosine);
  if (cosine < kPoleSine) return {std::atan2(e * R(x.k, x.j), R(x.j, x.j)), b, 0};
  return {std::atan2(-e * R(x.j, x.k), R(x.k, x.k)), b, std::atan2(-e * R(x.i, x.j), R(x.i, x.i))};
}

// R = Ri(a) Rj(b) Ri(c): R(i,i) = cos b, and the rest of row and column i are sin b times sines and
// cosines of c and a.
std::array<double, 3> two_axes(const Mat3& R, Axes x) {
  const double e = parity(x.i, x.j);
  const int k = 3 - x.i - x.j;
  const double sine = std::hypot(R(x.j, x.i), R(k, x.i));
  const double b = std::atan2(sine, R(x.i, x.i));
  if (sine < kPoleSine) return {std::atan2(e * R(k, x.j), R(x.j, x.j)), b, 0};
  return {std::atan2(R(x.j, x.i), -e * R(k, x.i)), b, std::atan2(R(x.i, x.j), e * R(x.i, k))};
}

Mat3 turn(int axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Vec3::Unit(axis)).toRotationMatrix();
}

}  // namespace

bool is_quaternion(RotationConvention convention) {
  return convention == RotationConvention::kQuaternionXyzw ||
         convention == RotationConvention::kQuaternionWxyz;
}

std::array<double, 3> angles_of(const Mat3& R, RotationConvention convention) {
  BINPICK_ASSERT(!is_quaternion(convention));
  if (convention == RotationConvention::kRotationVector) {
    const Vec3 w = rotation_vector(R);
    return {w.x(), w.y(), w.z()};
  }
  const Axes axes = axes_of(convention);
  auto angles = axes.i == axes.k ? two_axes(R, axes) : three_axes(R, axes);
  if (convention == RotationConvention::kFanucWpr) std::swap(angles[0], angles[2]);
  return angles;
}

Mat3 rotation_of(const std::array<double, 3>& angles_rad, RotationConvention convention) {
  BINPICK_ASSERT(!is_quaternion(convention));
  if (convention == RotationConvention::kRotationVector) {
    return rotation_from_vector({angles_rad[0], angles_rad[1], angles_rad[2]});
  }
  auto angles = angles_rad;
  if (convention == RotationConvention::kFanucWpr) std::swap(angles[0], angles[2]);
  const Axes axes = axes_of(convention);
  return turn(axes.i, angles[0]) * turn(axes.j, angles[1]) * turn(axes.k, angles[2]);
}

std::array<double, 4> quaternion_of(const Mat3& R, RotationConvention convention) {
  BINPICK_ASSERT(is_quaternion(convention));
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  if (convention == RotationConvention::kQuaternionWxyz) return {q.w(), q.x(), q.y(), q.z()};
  return {q.x(), q.y(), q.z(), q.w()};
}

Mat3 rotation_of_quaternion(const std::array<double, 4>& q, RotationConvention convention) {
  BINPICK_ASSERT(is_quaternion(convention));
  const bool scalar_first = convention == RotationConvention::kQuaternionWxyz;
  Eigen::Quaterniond quaternion = scalar_first ? Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                                               : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
  BINPICK_ASSERT(quaternion.norm() > 0);
  return quaternion.normalized().toRotationMatrix();
}

}  // namespace binpick::modbus
