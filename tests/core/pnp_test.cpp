// Convergence of PnP from perturbed poses, on exact points.
#include "pose/pnp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "binpick/geometry/angle.hpp"

namespace binpick {
namespace {

const CameraIntrinsics kCamera{640, 480, 800, 800, 319.5, 239.5};
constexpr double kDiameter_mm = 80;
constexpr int kTrials = 200;

Vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return {rotation_from_vector(3 * uniform(random) * random_unit(random)),
          {80 * uniform(random), 60 * uniform(random), 500 + 60 * uniform(random)}};
}

// Turned by exactly `angle_deg` about a random axis and shifted by exactly `shift_mm`.
Pose perturbed(const Pose& T, double angle_deg, double shift_mm, std::mt19937& random) {
  const Vec3 w = angle_deg * kDegree * random_unit(random), v = shift_mm * random_unit(random);
  return left_increment(T, w, v, T.t_mm);
}

// Points spread over a part; `with_normals`: each on an edge of a random direction in the image.
std::vector<Correspondence> exact_points(const Pose& T, int count, bool with_normals,
                                         std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<Correspondence> out;
  for (int i = 0; i < count; ++i) {
    const Vec3 point = kDiameter_mm * 0.6 * Vec3(uniform(random), uniform(random), uniform(random));
    const double turn = 2 * kPi * uniform(random);
    const Vec2 normal(std::cos(turn), std::sin(turn));
    out.push_back({point, kCamera.project(T * point), with_normals ? normal : Vec2(0, 0), 1});
  }
  return out;
}

struct Errors {
  double angle_deg, shift_mm;
};

Errors errors(const Pose& T, const Pose& truth) {
  return {rotation_angle_between(T.R, truth.R) / kDegree, (T.t_mm - truth.t_mm).norm()};
}

int count_converged(double angle_deg, double shift_mm, int points, bool with_normals,
                    unsigned seed) {
  std::mt19937 random(seed);
  int converged = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Pose truth = random_pose(random);
    const auto correspondences = exact_points(truth, points, with_normals, random);
    Pose T = perturbed(truth, angle_deg, shift_mm, random);
    solve_pnp(correspondences, kCamera, T);
    const Errors e = errors(T, truth);
    converged += e.angle_deg < 0.01 && e.shift_mm < 0.01;
  }
  return converged;
}

TEST(Pnp, ConvergesOnPointsFrom25Degrees) {
  const int converged = count_converged(25, 0.25 * kDiameter_mm, 40, false, 1);
  RecordProperty("converged", converged);
  EXPECT_EQ(kTrials, converged);
}

TEST(Pnp, ConvergesOnPointsFromAQuarterOfTheDistance) {
  EXPECT_GE(count_converged(10, 125, 40, false, 2), kTrials * 99 / 100);
}

TEST(Pnp, ConvergesOnEdgePointsFrom25Degrees) {
  const int converged = count_converged(25, 0.25 * kDiameter_mm, 80, true, 3);
  RecordProperty("converged", converged);
  EXPECT_GE(converged, kTrials * 98 / 100);
}

TEST(Pnp, ConvergesOnEdgePointsFromATemplatesSpacing) {
  EXPECT_EQ(kTrials, count_converged(10, 0.1 * kDiameter_mm, 80, true, 4));
}

TEST(Pnp, StatesItsResidual) {
  std::mt19937 random(5);
  const Pose truth = random_pose(random);
  auto correspondences = exact_points(truth, 60, false, random);
  Pose T = perturbed(truth, 10, 5, random);
  const PnpResult exact = solve_pnp(correspondences, kCamera, T);
  EXPECT_TRUE(exact.converged);
  EXPECT_LT(exact.rms_px, 1e-3);
  std::normal_distribution<double> noise(0, 0.5);
  for (Correspondence& c : correspondences) c.pixel += Vec2(noise(random), noise(random));
  const PnpResult noisy = solve_pnp(correspondences, kCamera, T);
  EXPECT_TRUE(noisy.converged);
  EXPECT_NEAR(0.5, noisy.rms_px, 0.1);
  const Errors e = errors(T, truth);
  EXPECT_LT(e.angle_deg, 1.0);
  EXPECT_LT(e.shift_mm, 3.0);
}

TEST(Pnp, AgreesWithItselfOnAStartAtTheTruth) {
  std::mt19937 random(6);
  const Pose truth = random_pose(random);
  Pose T = truth;
  EXPECT_TRUE(solve_pnp(exact_points(truth, 20, false, random), kCamera, T).converged);
  EXPECT_LT(errors(T, truth).shift_mm, 1e-6);
}

TEST(Pnp, LeavesThePoseWithoutEnoughPoints) {
  std::mt19937 random(7);
  const Pose truth = random_pose(random);
  const auto two = exact_points(truth, 2, false, random);
  const Pose start = perturbed(truth, 5, 5, random);
  Pose T = start;
  EXPECT_FALSE(solve_pnp(two, kCamera, T).converged);
  EXPECT_EQ(start.t_mm, T.t_mm);
  EXPECT_FALSE(solve_pnp({}, kCamera, T).converged);
  EXPECT_FALSE(solve_pnp(exact_points(truth, 5, true, random), kCamera, T).converged);
}

TEST(Pnp, LeavesAPoseBehindTheCamera) {
  std::mt19937 random(8);
  const Pose truth = random_pose(random);
  Pose T = truth;
  T.t_mm.z() = -300;
  EXPECT_FALSE(solve_pnp(exact_points(truth, 20, false, random), kCamera, T).converged);
  EXPECT_EQ(-300, T.t_mm.z());
}

}  // namespace
}  // namespace binpick
