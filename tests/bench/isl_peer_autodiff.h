// The peer a competent user would write: the linkage as one templated functor of six residuals and
// 38 parameters, Ceres' automatic differentiation (dual numbers with 38 parts), one residual block
// per pose, dense QR. As fast as careful writing makes it, without derivatives by hand.
//
// Residual of a pose, T_err = T_model^-1 * T_measured (Bonny's equations 3-7):
// position R_model^T (p_measured - p_model), and the projection angles atan2(E32, E22),
// atan2(E13, E33), atan2(E21, E11) of E = R_model^T R_measured; each row times its factor.
#pragma once

#include <memory>
#include <vector>

#include "tests/bench/isl_data.h"

namespace ceres {
class CostFunction;
}

namespace talus::bench {

Calibration calibrate_autodiff(const IslPoses& poses, const IslFactors& factors);

// Residual and Jacobian of one pose after the other, no solver about.
class IslAutodiff {
 public:
  IslAutodiff(const IslPoses& poses, const IslFactors& factors);
  ~IslAutodiff();
  int poses() const { return static_cast<int>(costs_.size()); }
  // residuals: 6 numbers; jacobian: 6 x 38, row by row.
  void evaluate(int pose, const IslParameters& at, double* residuals, double* jacobian) const;

 private:
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
};

}  // namespace talus::bench
