#include "framework/calibration/solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

class WholeProblem : public ceres::CostFunction {
 public:
  explicit WholeProblem(Problem& problem) : problem_(problem) {
    set_num_residuals(problem.size() + 1);
    mutable_parameter_block_sizes()->push_back(problem.size());
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const int n = problem_.size();
    const std::span<const double> at(x[0], static_cast<std::size_t>(n));
    if (!jacobians || !jacobians[0]) {  // a trial step: only the norm counts
      const double cost = problem_.cost(at);
      std::fill_n(residuals, n + 1, 0.0);
      residuals[n] = std::sqrt(2 * cost);
      return std::isfinite(cost);
    }
    const Normal normal = problem_.normal(at);
    if (!normal.factor.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, n + 1) = normal.factor.col(n);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], n + 1, n) =
        normal.factor.leftCols(n);
    return true;
  }

 private:
  Problem& problem_;
};

std::string words(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE: {
      if (summary.message.starts_with("Function tolerance")) return "cost no longer changes";
      if (summary.message.starts_with("Parameter tolerance")) return "parameters no longer change";
      if (summary.message.starts_with("Gradient tolerance")) return "gradient is zero";
      return "converged";
    }
    case ceres::NO_CONVERGENCE: return "iteration limit";
    default: return "failed: " + summary.message;
  }
}

}  // namespace

SolveReport solve(Problem& problem, std::vector<double>& x, const SolveOptions& options) {
  SolveReport report;
  const int n = problem.size();
  if (n == 0 || static_cast<int>(options.held.size()) == n) {
    report.converged = true;
    report.initial_cost = report.final_cost = problem.cost(x);
    report.stopped = "nothing to solve for";
    return report;
  }
  report.initial_cost = report.final_cost = problem.cost(x);
  if (!std::isfinite(report.initial_cost)) {
    report.final_cost = std::numeric_limits<double>::infinity();
    report.stopped = "the model cannot be evaluated at the start";
    return report;
  }
  ceres::Problem ceres_problem;
  ceres_problem.AddParameterBlock(x.data(), n);
  ceres_problem.AddResidualBlock(new WholeProblem(problem), nullptr, x.data());
  for (int i = 0; i < n; ++i)
    if (const auto& bounds = problem.quantity(i).bounds) {
      ceres_problem.SetParameterLowerBound(x.data(), i, bounds->first);
      ceres_problem.SetParameterUpperBound(x.data(), i, bounds->second);
      x[i] = std::clamp(x[i], bounds->first, bounds->second);
    }
  if (!options.held.empty()) ceres_problem.SetManifold(x.data(), new ceres::SubsetManifold(n, options.held));
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.gradient_tolerance = 1e-14;
  solver.initial_trust_region_radius = 1e6;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  report.converged = summary.termination_type == ceres::CONVERGENCE;
  report.iterations = static_cast<int>(summary.iterations.size()) - 1;
  report.initial_cost = summary.initial_cost;
  report.final_cost = summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
  report.seconds = summary.total_time_in_seconds;
  report.stopped = words(summary);
  return report;
}

}  // namespace talus
