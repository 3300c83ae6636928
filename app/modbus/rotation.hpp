// Rotation matrices to and from what robot controllers take. Angles in rad. Thread-safe: no state.
//
// Definitions, each with R = what maps the moved axes to the fixed ones and Rx, Ry, Rz the turns
// about one axis by the right-hand rule:
//   KUKA A B C            turns about Z, then the new Y, then the new X: R = Rz(A) Ry(B) Rx(C)
//                         (KUKA System Software, operating instructions, "Coordinate systems")
//   FANUC W P R           turns about the fixed X, Y, Z: R = Rz(R) Ry(P) Rx(W)
//                         (FANUC handling tool manual, "world frame"); Yaskawa Rx Ry Rz alike
//   Universal Robots      rotation vector: its direction is the axis, its length the angle
//                         (URScript manual, "poses": axis-angle vector)
//   ABB                   orient q1 q2 q3 q4, q1 the scalar part
//                         (RAPID reference manual, "orient"; q and -q are the same rotation)
//   Euler abc             turns about a, the new b, the new c: R = Ra(1) Rb(2) Rc(3)
// Three angles at a pole (second angle at +-90 deg, or 0 and 180 deg when the first axis comes
// again) are not unique: the third is 0 then.
#pragma once

#include <array>

#include "binpick/geometry/pose.hpp"
#include "modbus/register_map.hpp"

namespace binpick::modbus {

bool is_quaternion(map::RotationConvention convention);

// Three angles, or the rotation vector, in rad. Not for quaternions.
std::array<double, 3> angles_of(const Mat3& R, map::RotationConvention convention);
Mat3 rotation_of(const std::array<double, 3>& angles_rad, map::RotationConvention convention);

// In the order of the convention; the scalar part is not negative.
std::array<double, 4> quaternion_of(const Mat3& R, map::RotationConvention convention);
// The length need not be exactly 1 but must not be 0.
Mat3 rotation_of_quaternion(const std::array<double, 4>& q, map::RotationConvention convention);

}  // namespace binpick::modbus
