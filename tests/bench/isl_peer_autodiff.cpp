#include "tests/bench/isl_peer_autodiff.h"

#include <ceres/ceres.h>

#include <chrono>

namespace talus::bench {
namespace {

class IslResidual {
 public:
  IslResidual(const IslPose& pose, const IslFactors& factors) : pose_(pose), factors_(factors) {}

  template <class T>
  bool operator()(const T* parameters, T* residuals) const {
    using std::atan2;
    const IslFrame<T> model = isl_frame(parameters, pose_.readings.data());
    const auto& r = model.rotation;
    const std::array<double, 9>& measured = pose_.rotation;
    T difference[3];
    for (int i = 0; i < 3; ++i) difference[i] = pose_.position[i] - model.position[i];
    for (int i = 0; i < 3; ++i)
      residuals[i] = r[0][i] * difference[0] + r[1][i] * difference[1] + r[2][i] * difference[2];
    // Entry of E, counted from 0; the measured rotation carries no derivatives.
    const auto e = [&](int i, int j) {
      return r[0][i] * measured[j] + r[1][i] * measured[3 + j] + r[2][i] * measured[6 + j];
    };
    residuals[3] = atan2(e(2, 1), e(1, 1));
    residuals[4] = atan2(e(0, 2), e(2, 2));
    residuals[5] = atan2(e(1, 0), e(0, 0));
    for (int row = 0; row < isl_rows; ++row) residuals[row] *= factors_[row];
    return true;
  }

 private:
  const IslPose& pose_;
  const IslFactors& factors_;
};

using IslCost = ceres::AutoDiffCostFunction<IslResidual, isl_rows, isl_parameters>;

}  // namespace

Calibration calibrate_autodiff(const IslPoses& poses, const IslFactors& factors) {
  const auto start = std::chrono::steady_clock::now();
  Calibration result;
  result.parameters = isl_nominal();

  ceres::Problem problem;
  for (const IslPose& pose : poses)
    problem.AddResidualBlock(new IslCost(new IslResidual(pose, factors)), nullptr,
                             result.parameters.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

IslAutodiff::IslAutodiff(const IslPoses& poses, const IslFactors& factors) {
  for (const IslPose& pose : poses)
    costs_.push_back(std::make_unique<IslCost>(new IslResidual(pose, factors)));
}

IslAutodiff::~IslAutodiff() = default;

void IslAutodiff::evaluate(int pose, const IslParameters& at, double* residuals,
                           double* jacobian) const {
  const double* parameters = at.data();
  costs_[pose]->Evaluate(&parameters, residuals, &jacobian);
}

}  // namespace talus::bench
