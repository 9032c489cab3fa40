// Numerical derivatives of functions of a vector of doubles, to hold exact ones against.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace talus::testing {

// df/dx by central differences of sixth order; `step` is that of each entry.
inline Eigen::MatrixXd differences(
    const std::function<Eigen::VectorXd(const std::vector<double>&)>& f, std::vector<double> x,
    const std::vector<double>& step) {
  static constexpr double weight[] = {45, -9, 1};
  const Eigen::Index rows = f(x).size();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double here = x[i];
    for (int k = 1; k <= 3; ++k)
      for (int side : {1, -1}) {
        x[i] = here + side * k * step[i];
        J.col(static_cast<Eigen::Index>(i)) += side * weight[k - 1] * f(x);
      }
    x[i] = here;
    J.col(static_cast<Eigen::Index>(i)) /= 60 * step[i];
  }
  return J;
}

// The largest difference of two matrices, entry i, j in units of scale_i scale_j.
inline double farthest(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                       const Eigen::VectorXd& rows, const Eigen::VectorXd& columns) {
  return (rows.asDiagonal().inverse() * (a - b) * columns.asDiagonal().inverse())
      .cwiseAbs()
      .maxCoeff();
}

}  // namespace talus::testing
