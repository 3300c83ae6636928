#include "modbus/rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <random>

#include "binpick/geometry/angle.hpp"
#include "modbus/encoding.hpp"

namespace binpick::modbus {
namespace {

using map::RotationConvention;

constexpr double kRad = kDegree;

Mat3 matrix(std::initializer_list<double> rows) {
  Mat3 R;
  auto value = rows.begin();
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = *value++;
  return R;
}

void expect_angles(const Mat3& R, RotationConvention convention, double a, double b, double c) {
  const auto angles = angles_of(R, convention);
  EXPECT_NEAR(angles[0] / kRad, a, 1e-3);
  EXPECT_NEAR(angles[1] / kRad, b, 1e-3);
  EXPECT_NEAR(angles[2] / kRad, c, 1e-3);
  EXPECT_TRUE(rotation_of({a * kRad, b * kRad, c * kRad}, convention).isApprox(R, 1e-4));
}

// Rz(30) Ry(40) Rx(50), each element worked out by hand from the product of the three matrices.
const Mat3& turned_30_40_50() {
  static const Mat3 R = matrix({0.663414, 0.105040, 0.740843,  //
                                0.383022, 0.802872, -0.456826, -0.642788, 0.586824, 0.492404});
  return R;
}

TEST(Rotation, KukaTurnsAboutZThenYThenX) {
  expect_angles(turned_30_40_50(), RotationConvention::kKukaAbc, 30, 40, 50);
  expect_angles(turned_30_40_50(), RotationConvention::kEulerZyx, 30, 40, 50);
  // A = 90 deg: x points along y.
  expect_angles(matrix({0, -1, 0, 1, 0, 0, 0, 0, 1}), RotationConvention::kKukaAbc, 90, 0, 0);
}

TEST(Rotation, FanucAndYaskawaNameTheSameTurnsTheOtherWayRound) {
  expect_angles(turned_30_40_50(), RotationConvention::kFanucWpr, 50, 40, 30);
  // A tool that looks down: half a turn about x.
  expect_angles(matrix({1, 0, 0, 0, -1, 0, 0, 0, -1}), RotationConvention::kFanucWpr, 180, 0, 0);
}

TEST(Rotation, UniversalRobotsTakesAxisTimesAngle) {
  // x to y, y to z, z to x: 120 deg about the space diagonal.
  const Mat3 R = matrix({0, 0, 1, 1, 0, 0, 0, 1, 0});
  const auto w = angles_of(R, RotationConvention::kRotationVector);
  for (const double part : w) EXPECT_NEAR(part, 1.209200, 1e-6);  // 2 pi / 3 / sqrt(3)
  EXPECT_TRUE(rotation_of(w, RotationConvention::kRotationVector).isApprox(R, 1e-9));
}

TEST(Rotation, QuaternionsHaveTheirScalarPartWhereTheControllerWantsIt) {
  const Mat3 about_z = matrix({0, -1, 0, 1, 0, 0, 0, 0, 1});  // 90 deg
  const double h = std::sqrt(0.5);
  const auto abb = quaternion_of(about_z, RotationConvention::kQuaternionWxyz);
  const auto xyzw = quaternion_of(about_z, RotationConvention::kQuaternionXyzw);
  const std::array<double, 4> abb_expected = {h, 0, 0, h};
  const std::array<double, 4> xyzw_expected = {0, 0, h, h};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(abb[i], abb_expected[i], 1e-12);
    EXPECT_NEAR(xyzw[i], xyzw_expected[i], 1e-12);
  }
  EXPECT_TRUE(rotation_of_quaternion({-h, 0, 0, -h}, RotationConvention::kQuaternionWxyz)
                  .isApprox(about_z, 1e-12));
}

TEST(Rotation, EulerZyzAsKawasakiAndComau) {
  // Rz(90) Ry(90): z goes to x and then to y, x goes to -z, y goes to -x.
  expect_angles(matrix({0, -1, 0, 0, 0, 1, -1, 0, 0}), RotationConvention::kEulerZyz, 90, 90, 0);
  expect_angles(matrix({-1, 0, 0, 0, 1, 0, 0, 0, -1}), RotationConvention::kEulerZyz, 0, 180, 0);
}

TEST(Rotation, EulerXyzAsStaubli) {
  // Rx(90) Ry(90): x goes to -z and then to y, y goes to z, z goes to x.
  expect_angles(matrix({0, 0, 1, 1, 0, 0, 0, 1, 0}), RotationConvention::kEulerXyz, 90, 90, 0);
}

TEST(Rotation, EveryConventionGivesBackEveryRotation) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const auto& [value, name] : map::kRotationConventionNames) {
    SCOPED_TRACE(name);
    const auto convention = static_cast<RotationConvention>(value);
    for (int i = 0; i < 500; ++i) {
      Mat3 R = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                   .normalized()
                   .toRotationMatrix();
      // Every fifth is a product of quarter turns: all the poles are among these.
      if (i % 5 == 0) {
        R = Mat3::Identity();
        for (int bits = i / 5, k = 0; k < 4; ++k, bits /= 3) {
          R *= Mat3(Eigen::AngleAxisd(kPi / 2, Vec3::Unit(bits % 3)));
        }
      }
      const Mat3 back = is_quaternion(convention)
                            ? rotation_of_quaternion(quaternion_of(R, convention), convention)
                            : rotation_of(angles_of(R, convention), convention);
      ASSERT_TRUE(back.isApprox(R, 1e-7)) << R << "\n" << back;
    }
  }
}

TEST(Encoding, PosesComeBackWithinTheResolutionOfTheirRegisters) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-3000, 3000);
  std::normal_distribution<double> normal;
  for (const auto& [value, name] : map::kRotationConventionNames) {
    for (unsigned units = 0; units < 16; ++units) {
      const auto encoding = encoding_of(static_cast<std::uint16_t>(value | units << 8U));
      ASSERT_TRUE(encoding);
      EXPECT_EQ(conventions_word(*encoding), value | units << 8U);
      for (int i = 0; i < 20; ++i) {
        const Mat3 R =
            Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                .normalized()
                .toRotationMatrix();
        const Pose pose{R, {place(random), place(random), place(random)}};
        std::array<std::uint16_t, kPoseWords> words{};
        ASSERT_TRUE(put_pose(words, *encoding, pose));
        const auto back = get_pose(words, *encoding);
        ASSERT_TRUE(back);
        EXPECT_LE((back->t_mm - pose.t_mm).cwiseAbs().maxCoeff(), 0.0013);
        const double tolerance_deg = is_quaternion(encoding->rotation) ? 0.004 : 0.0004;
        EXPECT_LE(Eigen::AngleAxisd(Mat3(back->R.transpose() * pose.R)).angle() / kRad,
                  tolerance_deg)
            << name;
      }
    }
  }
}

TEST(Encoding, WritesMillimetresAndDegreesAsTheTableSays) {
  std::array<std::uint16_t, kPoseWords> words{};
  Pose pose;
  pose.t_mm = {1, -1, 100};
  pose.R = turned_30_40_50();
  ASSERT_TRUE(put_pose(words, {.rotation = RotationConvention::kKukaAbc}, pose));
  EXPECT_EQ(words[1], 1000);    // 1 mm
  EXPECT_EQ(words[2], 0xFFFF);  // -1 mm = -1000
  EXPECT_EQ(words[3], 0x10000 - 1000);
  EXPECT_EQ(words[4] << 16 | words[5], 100'000);
  EXPECT_NEAR(words[6] << 16 | words[7], 300'000, 3);    // 30 deg
  EXPECT_NEAR(words[8] << 16 | words[9], 400'000, 3);    // 40 deg
  EXPECT_NEAR(words[10] << 16 | words[11], 500'000, 3);  // 50 deg
}

TEST(Encoding, RefusesWhatIsNoPose) {
  std::array<std::uint16_t, kPoseWords> words{};
  const Encoding quaternion{.rotation = RotationConvention::kQuaternionWxyz};
  EXPECT_FALSE(get_pose(words, quaternion));  // all 0
  words[6] = 16384;                           // length 0.5
  EXPECT_FALSE(get_pose(words, quaternion));
  words[6] = 32767;
  EXPECT_TRUE(get_pose(words, quaternion));
  Pose pose;
  pose.t_mm.x() = std::nan("");
  EXPECT_FALSE(put_pose(words, {}, pose));
  EXPECT_EQ(words, (std::array<std::uint16_t, kPoseWords>{}));
  EXPECT_FALSE(encoding_of(0xF000));
  EXPECT_FALSE(encoding_of(9));  // no such rotation convention
}

}  // namespace
}  // namespace binpick::modbus
