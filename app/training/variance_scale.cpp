#include "training/variance_scale.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kPosesMin = 10;
// Of six normal errors: the median of the sum of their squares (chi-squared, 6 degrees of freedom).
constexpr double kMedianOfSix = 5.348;

using Vec6 = Eigen::Matrix<double, 6, 1>;

// Turn (rad) and shift of the centre (mm), as the covariance has them.
Vec6 centre_error(const PoseError6& error, const Pose& estimate, const Vec3& centre_mm) {
  const Vec3 shift(error[0], error[1], error[2]);
  const Vec3 turn = Vec3(error[3], error[4], error[5]) * kDegree;
  Vec6 out;
  out << turn, shift + turn.cross(estimate.R * centre_mm);
  return out;
}

}  // namespace

std::optional<double> growth_of_variance(const PileTrial& trial, const PartGeometry& geometry,
                                         const Vec3& centre_mm) {
  const PoseLimits limits;
  std::vector<double> squares;
  for (std::size_t i = 0; i < trial.rows.size(); ++i) {
    const ResultRow& row = trial.rows[i];
    if (row.score < 0.5) continue;
    for (const ScoredInstance& instance : trial.truth.at(row.frame)) {
      const Pose& truth = instance.truth.T_cam_obj;
      if (!is_right(geometry, row.T_cam_obj, truth, limits)) continue;
      const PoseError6 error = geometry.six_errors(row.T_cam_obj, truth, limits);
      const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(
          trial.uncertainty[i].covariance.data());
      const Vec6 e = centre_error(error, row.T_cam_obj, centre_mm);
      squares.push_back(e.dot(covariance.ldlt().solve(e)));
      break;
    }
  }
  if (squares.size() < kPosesMin) return std::nullopt;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle / kMedianOfSix;
}

}  // namespace binpick::app
