#include "binpick/geometry/pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "binpick/geometry/angle.hpp"

namespace binpick {
namespace {

Vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

double largest_difference(const Mat3& A, const Mat3& B) {
  return (A - B).cwiseAbs().maxCoeff();
}

TEST(RotationVector, ComesBackAtEveryAngle) {
  std::mt19937 random(1);
  for (const double angle : {1e-12, 1e-9, 1e-7, 1e-4, 0.1, 1.0, 2.0, 3.0, 3.14, kPi - 1e-5}) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 w = angle * random_unit(random);
      EXPECT_LT((rotation_vector(rotation_from_vector(w)) - w).norm(), 1e-9 + 1e-7 * angle)
          << angle;
    }
  }
}

TEST(RotationVector, OfHalfATurnGivesTheSameRotation) {
  std::mt19937 random(2);
  for (const double angle : {kPi - 1e-9, kPi, kPi + 1e-6, 4.0, 6.2}) {
    for (int i = 0; i < 20; ++i) {
      const Mat3 R = rotation_from_vector(angle * random_unit(random));
      const Vec3 w = rotation_vector(R);
      EXPECT_LE(w.norm(), kPi + 1e-9);
      EXPECT_LT(largest_difference(R, rotation_from_vector(w)), 1e-7) << angle;
    }
  }
}

TEST(RotationVector, TurnsTheRightWay) {
  const Mat3 R = rotation_from_vector(Vec3(0, 0, kPi / 2));
  EXPECT_LT((R * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_LT((rotation_vector(Mat3::Identity())).norm(), 1e-12);
}

TEST(RotationFromVector, IsOrthonormalEverywhere) {
  std::mt19937 random(3);
  for (const double angle : {0.0, 1e-10, 1e-8, 1e-5, 0.5, 3.0, 9.0}) {
    const Mat3 R = rotation_from_vector(angle * random_unit(random));
    EXPECT_LT(largest_difference(R * R.transpose(), Mat3::Identity()), 1e-12) << angle;
    EXPECT_NEAR(1, R.determinant(), 1e-12);
  }
}

TEST(RotationAngle, IsThatOfTheTurnBetween) {
  std::mt19937 random(4);
  for (const double angle : {0.0, 0.01, 0.7, 2.5, kPi}) {
    const Mat3 A = rotation_from_vector(2.0 * random_unit(random));
    const Mat3 B = A * rotation_from_vector(angle * random_unit(random));
    EXPECT_NEAR(angle, rotation_angle_between(A, B), 1e-7);
  }
}

TEST(RotationBetween, TakesOneDirectionToTheOther) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_unit(random), b = random_unit(random);
    const Mat3 R = rotation_between(a, b);
    EXPECT_LT((R * a - b).norm(), 1e-9);
    EXPECT_LT(largest_difference(R * R.transpose(), Mat3::Identity()), 1e-9);
    // The smallest rotation: by the angle between the two.
    EXPECT_NEAR(std::acos(std::clamp(a.dot(b), -1.0, 1.0)),
                rotation_angle_between(Mat3::Identity(), R), 1e-6);
  }
}

TEST(RotationBetween, OfOppositeDirectionsIsHalfATurn) {
  std::mt19937 random(6);
  for (int i = 0; i < 50; ++i) {
    const Vec3 a = i < 3 ? Vec3(Vec3::Unit(i)) : random_unit(random);
    const Mat3 R = rotation_between(a, -a);
    EXPECT_LT((R * a + a).norm(), 1e-6);
    EXPECT_NEAR(1, R.determinant(), 1e-9);
    EXPECT_LT(largest_difference(rotation_between(a, a), Mat3::Identity()), 1e-12);
  }
}

TEST(RotationBetween, HoldsNextToOppositeDirections) {
  std::mt19937 random(7);
  for (const double off : {1e-7, 1e-6, 3e-6, 1e-5, 1e-4, 1e-3}) {
    for (int i = 0; i < 20; ++i) {
      const Vec3 a = random_unit(random);
      const Vec3 b = (-a + off * random_unit(random)).normalized();
      const Mat3 R = rotation_between(a, b);
      // 1 + cos of the angle, which the formula divides by, has lost its digits here.
      const double tolerance = 2e-6 + 4e-15 / (off * off);
      EXPECT_LT((R * a - b).norm(), std::min(tolerance, 1e-3)) << off;
      EXPECT_LT(largest_difference(R * R.transpose(), Mat3::Identity()), 1e-3) << off;
    }
  }
}

TEST(Orthonormalized, RemovesDriftAndKeepsRotations) {
  std::mt19937 random(8);
  const Mat3 R = rotation_from_vector(1.3 * random_unit(random));
  EXPECT_LT(largest_difference(R, orthonormalized(R)), 1e-12);
  const Mat3 drifted = R + 1e-4 * Mat3::Random();
  const Mat3 repaired = orthonormalized(drifted);
  EXPECT_LT(largest_difference(repaired * repaired.transpose(), Mat3::Identity()), 1e-12);
  EXPECT_NEAR(1, repaired.determinant(), 1e-12);
  EXPECT_LT(rotation_angle_between(R, repaired), 5e-4);
}

TEST(Pose, ComposesAndInverts) {
  std::mt19937 random(9);
  const Pose A{rotation_from_vector(random_unit(random)), {10, -20, 500}};
  const Pose B{rotation_from_vector(2 * random_unit(random)), {1, 2, 3}};
  const Vec3 x(7, -8, 9);
  EXPECT_LT(((A * B) * x - A * (B * x)).norm(), 1e-10);
  EXPECT_LT((A.inverse() * (A * x) - x).norm(), 1e-10);
}

TEST(LeftIncrement, TurnsAboutThePivotAndThenShifts) {
  const Pose T{rotation_from_vector({0.1, -0.4, 0.2}), {30, -10, 600}};
  const Vec3 w(0.2, 0.1, -0.3), v(1, 2, 3), pivot(25, -5, 580), x(4, 5, 6);
  const Pose moved = left_increment(T, w, v, pivot);
  const Vec3 expected = rotation_from_vector(w) * (T * x - pivot) + pivot + v;
  EXPECT_LT((moved * x - expected).norm(), 1e-10);
  // About its own origin a pose turns on the spot.
  EXPECT_LT((left_increment(T, w, Vec3::Zero(), T.t_mm).t_mm - T.t_mm).norm(), 1e-10);
  const Pose same = left_increment(T, Vec3::Zero(), Vec3::Zero(), pivot);
  EXPECT_LT((same.t_mm - T.t_mm).norm() + largest_difference(same.R, T.R), 1e-12);
}

}  // namespace
}  // namespace binpick
