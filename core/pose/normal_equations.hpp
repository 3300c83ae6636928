// Weighted least squares over a pose increment (rotation vector in rad, then translation in mm;
// left increment about a pivot, see left_increment()).
#pragma once

#include <Eigen/Cholesky>

#include "binpick/geometry/pose.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick {

struct NormalEquations {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();  // the lower triangle
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double cost = 0;
  double information = 0;  // sum over the residuals of 1 / sigma^2
  int count = 0;

  // Residuals that a kernel has summed, each with standard deviation sigma.
  void add(const simd::EquationSums& sums, double sigma) {
    const double scale = 1 / (sigma * sigma);
    int k = 0;
    for (int column = 0; column < 6; ++column) {
      g[column] += scale * static_cast<double>(sums.g[column]);
      for (int row = column; row < 6; ++row)
        H(row, column) += scale * static_cast<double>(sums.H[k++]);
    }
    cost += scale * static_cast<double>(sums.cost);
    information += scale * sums.count;
    count += sums.count;
  }

  // Minimizer with a prior that the pose stays: `rotation` in 1/rad^2 and `shift` in 1/mm^2 are
  // added to the diagonal, so that a direction that the data does not hold stays where it is.
  Eigen::Matrix<double, 6, 1> solve(double rotation, double shift) const {
    Eigen::Matrix<double, 6, 6> A = H;
    A.diagonal().head<3>().array() += rotation;
    A.diagonal().tail<3>().array() += shift;
    return A.selfadjointView<Eigen::Lower>().llt().solve(-g);
  }
};

}  // namespace binpick
