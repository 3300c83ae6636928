#include "pose/uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pose/align.hpp"

namespace binpick {
namespace {

constexpr double kPriorShare = 0.25;         // of the diameter
constexpr double kUnobservableShare = 0.05;  // of the diameter

struct WeakAxis {
  Vec3 direction;
  double deviation;
};

WeakAxis weak_axis(const Mat3& covariance) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(covariance);  // ascending
  return {solver.eigenvectors().col(2), std::sqrt(std::max(0.0, solver.eigenvalues()[2]))};
}

}  // namespace

PoseUncertainty pose_uncertainty(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const double diameter_mm = model.info().diameter_mm;
  const double radius_mm = diameter_mm / 4;  // of what turns with the part, on average
  const NormalEquations equations = final_equations(model, scene, T);
  // Residuals that scatter more than the assumed noise tell less; that they scatter less does not
  // make the data better.
  const double scatter = std::max(1.0, equations.cost / std::max(1, equations.count - 6));
  Eigen::Matrix<double, 6, 6> information = equations.H.selfadjointView<Eigen::Lower>();
  information /= scatter * model.trials().variance_scale_of(scene.modality());
  const double prior_mm = kPriorShare * diameter_mm, prior_rad = prior_mm / radius_mm;
  information.diagonal().head<3>().array() += 1 / (prior_rad * prior_rad);
  information.diagonal().tail<3>().array() += 1 / (prior_mm * prior_mm);
  const Eigen::Matrix<double, 6, 6> covariance =
      information.ldlt().solve(Eigen::Matrix<double, 6, 6>::Identity());

  PoseUncertainty out;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out.covariance.data()) = covariance;
  const WeakAxis turn = weak_axis(covariance.topLeftCorner<3, 3>());
  const WeakAxis shift = weak_axis(covariance.bottomRightCorner<3, 3>());
  out.weak_turn = turn.direction;
  out.weak_turn_rad = turn.deviation;
  out.weak_shift = shift.direction;
  out.weak_shift_mm = shift.deviation;
  out.shift_observable = shift.deviation < kUnobservableShare * diameter_mm;
  out.turn_observable = turn.deviation * radius_mm < kUnobservableShare * diameter_mm;
  return out;
}

}  // namespace binpick
