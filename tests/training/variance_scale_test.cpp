#include "training/variance_scale.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/bracket.hpp"

namespace binpick::app {
namespace {

// Two hundred parts; each estimate is off by normal errors of the centre of `deviation_mm` and of
// the turn of `deviation_rad`, and the covariance claims half of both.
TEST(VarianceScale, GrowsByTheSquareOfWhatTheErrorsExceed) {
  constexpr double kDeviation_mm = 0.4, kDeviation_rad = 0.01;
  const Vec3 centre_mm(12, -7, 30);  // far from the origin, which turns with it
  drivers::BopModel part;
  part.obj_id = kPileObject;
  part.diameter_mm = train::mesh_bounds(bracket_mesh()).diameter_mm;
  const PartGeometry geometry(part, bracket_mesh());
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  PileTrial trial;
  for (int i = 0; i < 200; ++i) {
    ScoredInstance instance;
    instance.truth.obj_id = kPileObject;
    instance.truth.T_cam_obj =
        bracket_pose(20, 7.0 * i, 3.0 * i, Vec3(400.0 * (i % 20), 400.0 * (i / 20), 500));
    const Pose& truth = instance.truth.T_cam_obj;
    trial.truth[{1, 0}].push_back(instance);
    const Vec3 turn = kDeviation_rad * Vec3(normal(random), normal(random), normal(random));
    const Vec3 shift = kDeviation_mm * Vec3(normal(random), normal(random), normal(random));
    Pose estimate;
    estimate.R = rotation_from_vector(turn) * truth.R;
    estimate.t_mm = truth * centre_mm + shift - estimate.R * centre_mm;
    trial.rows.push_back({{1, 0}, kPileObject, 0.9, estimate, 0.1});
    PoseUncertainty claimed;
    for (std::size_t k = 0; k < 6; ++k) {
      const double deviation = (k < 3 ? kDeviation_rad : kDeviation_mm) / 2;
      claimed.covariance[7 * k] = deviation * deviation;
    }
    trial.uncertainty.push_back(claimed);
  }
  const auto growth = growth_of_variance(trial, geometry, centre_mm);
  ASSERT_TRUE(growth.has_value());
  EXPECT_NEAR(*growth, 4, 0.6);

  trial.rows.resize(5);
  EXPECT_FALSE(growth_of_variance(trial, geometry, centre_mm).has_value()) << "too few to tell";
}

}  // namespace
}  // namespace binpick::app
