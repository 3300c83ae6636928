// When two poses of a symmetric part are the same.
#include "pose/symmetry_transforms.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "pose/view_lookup.hpp"
#include "symmetry_rows.hpp"

namespace binpick {
namespace {

// The bracket of the other tests, said to have these symmetries.
struct Part {
  std::vector<std::uint8_t> bytes;
  ArenaPlan plan;
  std::unique_ptr<Arena> arena;
  SymmetryTransforms symmetries;

  Part(const std::vector<SymmetryTurn>& turns, const std::vector<SymmetryAxis>& axes)
      : bytes(with_symmetry(tiny(), turns, axes)) {
    const Result<ObjectModel> model = ObjectModel::parse(bytes);
    BINPICK_ASSERT(model.ok());
    SymmetryTransforms::plan(model.value(), plan);
    arena = std::make_unique<Arena>(plan.bytes);
    symmetries = SymmetryTransforms(model.value(), *arena);
    EXPECT_EQ(plan.bytes, arena->used_bytes());
  }
  static const std::vector<std::uint8_t>& tiny() {
    static const std::vector<std::uint8_t> once = tiny_model_bytes();
    return once;
  }
  ObjectModel model() const { return ObjectModel::parse(bytes).value(); }
};

SymmetryAxis about_z(double x_mm, SymmetryKind kind = SymmetryKind::kExact) {
  return axis_row(Vec3::UnitZ(), x_mm, kind);
}

Pose turned(const Vec3& axis, double angle_deg, const Vec3& point_mm = Vec3::Zero()) {
  const Mat3 R = rotation_from_vector(axis * angle_deg * kDegree);
  return {R, point_mm - R * point_mm};
}

const Pose kPose{rotation_from_vector(Vec3(0.3, -0.8, 1.9)), Vec3(40, -20, 600)};
const simd::PoseKernels kKernels = simd::pose_kernels_scalar();
constexpr double kMm = 0.5, kRad = 2 * kDegree;

TEST(SymmetryTransforms, WithoutASymmetryOnlyTheSamePoseIsTheSame) {
  const Part part({}, {});
  EXPECT_TRUE(part.symmetries.same(kPose, kPose * turned(Vec3::UnitX(), 1.9), kMm, kRad));
  EXPECT_FALSE(part.symmetries.same(kPose, kPose * turned(Vec3::UnitX(), 2.1), kMm, kRad));
  EXPECT_FALSE(part.symmetries.same(kPose, kPose * Pose{Mat3::Identity(), {0.6, 0, 0}}, kMm, kRad));
  EXPECT_TRUE(part.symmetries.near_rotations().empty());
  EXPECT_TRUE(part.symmetries.near_angles().empty());
}

TEST(SymmetryTransforms, TurnsOffTheMiddleCountWithTheirShift) {
  const Part part({turn_row(Vec3::UnitZ(), 180, 5)}, {});
  const Pose flipped = kPose * turned(Vec3::UnitZ(), 180, {5, 0, 0});
  EXPECT_GT((flipped.t_mm - kPose.t_mm).norm(), 9);
  EXPECT_TRUE(part.symmetries.same(kPose, flipped, kMm, kRad));
  EXPECT_TRUE(part.symmetries.same(flipped, kPose, kMm, kRad));
  EXPECT_FALSE(part.symmetries.same(kPose, kPose * turned(Vec3::UnitZ(), 180), kMm, kRad));
  EXPECT_FALSE(part.symmetries.same(kPose, kPose * turned(Vec3::UnitX(), 180), kMm, kRad));
}

TEST(SymmetryTransforms, StateHowFarTheyShiftTheCentre) {
  EXPECT_EQ(0, Part({turn_row(Vec3::UnitZ(), 180)}, {}).symmetries.centre_shift_max_mm());
  const Part beside({turn_row(Vec3::UnitZ(), 180, 5), turn_row(Vec3::UnitZ(), 90, 5)}, {});
  EXPECT_NEAR(10, beside.symmetries.centre_shift_max_mm(), 1e-5);
  EXPECT_NEAR(6, Part({}, {about_z(3)}).symmetries.centre_shift_max_mm(), 1e-5);
}

TEST(SymmetryTransforms, AnyAngleAboutAnAxisIsTheSame) {
  const Part part({turn_row(Vec3::UnitX(), 180)}, {about_z(3)});
  for (const double angle : {1.0, 77.0, 180.0, 299.0}) {
    const Pose b = kPose * turned(Vec3::UnitZ(), angle, {3, 0, 0});
    EXPECT_TRUE(part.symmetries.same(kPose, b, kMm, kRad)) << angle;
    EXPECT_TRUE(part.symmetries.same(kPose * turned(Vec3::UnitX(), 180), b, kMm, kRad)) << angle;
    EXPECT_FALSE(part.symmetries.same(kPose, b * turned(Vec3::UnitX(), 5), kMm, kRad)) << angle;
  }
}

TEST(SymmetryTransforms, OfABallOnlyThePlaceCounts) {
  const Part part({}, {about_z(0), axis_row(Vec3::UnitX())});
  EXPECT_TRUE(part.symmetries.same(kPose, kPose * turned(Vec3::UnitY(), 123), kMm, kRad));
  EXPECT_FALSE(part.symmetries.same(kPose, kPose * Pose{Mat3::Identity(), {0.6, 0, 0}}, kMm, kRad));
}

// How near the part is seen to one of the model's viewpoints.
double nearness(const ObjectModel& model, const Pose& T) {
  return viewing_direction(nearest_viewpoint(model, kKernels, T))
      .dot(T.R.transpose() * T.t_mm.normalized());
}

// A turn about an axis beside the middle shifts the part, and so the ray that it is seen along.
constexpr double kPerspective = 0.01;

TEST(SymmetryTransforms, TheCanonicalPoseIsTheEqualOneNearestToAViewpoint) {
  const Part flips({turn_row(Vec3::UnitX(), 180, 2)}, {}), round({}, {about_z(3)}),
      ball({}, {about_z(0), axis_row(Vec3::UnitX())});
  for (int i = 0; i < 50; ++i) {
    const Pose T{rotation_from_vector(Vec3(0.13 * i, 1.1 - 0.05 * i, 0.7)), Vec3(30, -20, 500)};
    for (const Part* part : {&flips, &round, &ball}) {
      const Pose same = part->symmetries.canonical(part->model(), kKernels, T);
      EXPECT_TRUE(part->symmetries.same(T, same, 1e-6, 1e-5)) << i;
      EXPECT_GE(nearness(part->model(), same), nearness(part->model(), T) - kPerspective) << i;
    }
    const Pose flipped = T * turned(Vec3::UnitX(), 180);
    EXPECT_GE(nearness(flips.model(), flips.symmetries.canonical(flips.model(), kKernels, T)),
              nearness(flips.model(), flipped) - kPerspective);
    EXPECT_NEAR(1, nearness(ball.model(), ball.symmetries.canonical(ball.model(), kKernels, T)),
                1e-6);
  }
  const Part none({}, {});
  EXPECT_TRUE(none.symmetries.canonical(none.model(), kKernels, kPose).R == kPose.R);
}

TEST(SymmetryTransforms, NearAnglesAreListedOnceForAllThatLookTheSame) {
  const Part plain({}, {about_z(0, SymmetryKind::kNear)});
  EXPECT_EQ(31u, plain.symmetries.near_angles().size());
  const Part fourfold(
      {turn_row(Vec3::UnitZ(), 90), turn_row(Vec3::UnitZ(), 180), turn_row(Vec3::UnitZ(), -90)},
      {about_z(0, SymmetryKind::kNear)});
  EXPECT_EQ(7u, fourfold.symmetries.near_angles().size());
  const Part flipped(
      {turn_row(Vec3::UnitX(), 180), turn_row(Vec3::UnitY(), 180, 0, SymmetryKind::kNear),
       turn_row(Vec3::UnitZ(), 180, 0, SymmetryKind::kNear)},
      {});
  EXPECT_EQ(1u, flipped.symmetries.near_rotations().size());
}

SymmetryTurn near_half_turn(SymmetryKind kind) {
  return turn_row(Vec3::UnitX(), 180, 0, kind);
}

constexpr NearSymmetry kAuto = NearSymmetry::kAuto;

TEST(LooksSame, NearTurnsCountWhereDetectionCannotTellThem) {
  const Part told({near_half_turn(SymmetryKind::kNear)}, {}),
      untold({near_half_turn(SymmetryKind::kIndistinguishable)}, {});
  const Pose flipped = kPose * turned(Vec3::UnitX(), 180);
  EXPECT_TRUE(untold.symmetries.looks_same(kPose, flipped, kMm, kRad, kAuto));
  EXPECT_FALSE(untold.symmetries.same(kPose, flipped, kMm, kRad));
  EXPECT_FALSE(told.symmetries.looks_same(kPose, flipped, kMm, kRad, kAuto));
  const Pose half = kPose * turned(Vec3::UnitX(), 90);
  EXPECT_FALSE(untold.symmetries.looks_same(kPose, half, kMm, kRad, kAuto));
  EXPECT_TRUE(untold.symmetries.looks_same(kPose, kPose, kMm, kRad, kAuto));
  // Whoever asks may decide.
  EXPECT_TRUE(told.symmetries.looks_same(kPose, flipped, kMm, kRad, NearSymmetry::kEquivalent));
  EXPECT_FALSE(untold.symmetries.looks_same(kPose, flipped, kMm, kRad, NearSymmetry::kDistinct));
  EXPECT_TRUE(told.symmetries.has_any(NearSymmetry::kEquivalent));
  EXPECT_FALSE(told.symmetries.has_any(kAuto));
  EXPECT_TRUE(untold.symmetries.has_any(kAuto));
  EXPECT_FALSE(untold.symmetries.has_any(NearSymmetry::kDistinct));
  // It is an alternative of a pose either way.
  EXPECT_EQ(untold.symmetries.near_rotations().size(), 1u);
}

TEST(LooksSame, AnyAngleAboutAnIndistinguishableAxisAndTurnedOver) {
  const Part part({near_half_turn(SymmetryKind::kIndistinguishable)},
                  {about_z(0, SymmetryKind::kIndistinguishable)});
  for (const double angle_deg : {3.0, 47.0, 171.0}) {
    const Pose rolled = kPose * turned(Vec3::UnitZ(), angle_deg);
    EXPECT_TRUE(part.symmetries.looks_same(kPose, rolled, kMm, kRad, kAuto)) << angle_deg;
    EXPECT_TRUE(
        part.symmetries.looks_same(kPose, rolled * turned(Vec3::UnitX(), 180), kMm, kRad, kAuto))
        << angle_deg;
    EXPECT_FALSE(
        part.symmetries.looks_same(kPose, rolled * turned(Vec3::UnitX(), 20), kMm, kRad, kAuto))
        << angle_deg;
  }
}

}  // namespace
}  // namespace binpick
