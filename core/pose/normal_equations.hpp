// Weighted least squares over a pose increment (rotation vector in rad, then translation in mm;
// left increment about a pivot, see left_increment()).
#pragma once

#include <Eigen/Cholesky>

#include "binpick/geometry/pose.hpp"

namespace binpick {

struct NormalEquations {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();  // the lower triangle
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double cost = 0;
  int count = 0;

  // Residual r with gradient J and weight w.
  void add(const Eigen::Matrix<double, 6, 1>& J, double r, double w) {
    const Eigen::Matrix<double, 6, 1> weighted = w * J;
    for (int column = 0; column < 6; ++column)
      for (int row = column; row < 6; ++row) H(row, column) += weighted[row] * J[column];
    g.noalias() += w * r * J;
    cost += w * r * r;
    ++count;
  }

  // Minimizer with Levenberg damping: `turn_damping` in 1/rad^2 and `shift_damping` in 1/mm^2 are
  // added to the diagonal, so that a direction that the data does not hold stays where it is.
  Eigen::Matrix<double, 6, 1> solve(double turn_damping, double shift_damping) const {
    Eigen::Matrix<double, 6, 6> A = H;
    A.diagonal().head<3>().array() += turn_damping;
    A.diagonal().tail<3>().array() += shift_damping;
    return A.selfadjointView<Eigen::Lower>().ldlt().solve(-g);
  }
};

// Geman-McClure: full weight near zero, 1/25 where the residual reaches the scale.
inline double robust_weight(double residual, double scale) {
  const double k = residual * residual / (scale * scale);
  return 1 / ((1 + 4 * k) * (1 + 4 * k));
}

// Derivative of n . x(increment) for a point x turning about the pivot.
inline Eigen::Matrix<double, 6, 1> point_gradient(const Vec3& n, const Vec3& x, const Vec3& pivot) {
  Eigen::Matrix<double, 6, 1> J;
  J.head<3>() = (x - pivot).cross(n);
  J.tail<3>() = n;
  return J;
}

}  // namespace binpick
