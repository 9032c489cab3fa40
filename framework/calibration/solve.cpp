#include "framework/calibration/solve.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {
namespace {

class WholeProblem : public ceres::CostFunction {
 public:
  // `broken` is set where the cost has a value but its derivatives do not. Ceres would write about
  // such a point to standard error; it is told instead that nothing falls any more.
  WholeProblem(Problem& problem, bool& broken) : problem_(problem), broken_(broken) {
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
    if (!normal.factor.allFinite()) {
      broken_ = true;
      std::fill_n(residuals, n + 1, 0.0);
      std::fill_n(jacobians[0], (n + 1) * n, 0.0);
      return true;
    }
    Eigen::Map<Eigen::VectorXd>(residuals, n + 1) = normal.factor.col(n);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[0], n + 1, n) = normal.factor.leftCols(n);
    return true;
  }

 private:
  Problem& problem_;
  bool& broken_;
};

// Ends a solution that creeps along a valley: over 25 iterations chi-square has fallen by less than
// a five-hundredth part of one residual's square, which no figure of the report shows.
class Creeping : public ceres::IterationCallback {
 public:
  explicit Creeping(const Problem& problem)
      : rows_(std::max<double>(1, static_cast<double>(problem.data().used()))),
        least_(problem.noise_known() ? 1 : 0) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    lowest_.push_back(lowest_.empty() ? summary.cost : std::min(lowest_.back(), summary.cost));
    const std::size_t n = lowest_.size();
    const double scale = std::max(least_, lowest_.back() / rows_);
    return n > 25 && lowest_[n - 26] - lowest_[n - 1] < 1e-3 * scale
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  double rows_, least_;
  std::vector<double> lowest_;
};

std::string words(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::USER_SUCCESS:
      return "cost no longer changes noticeably";
    case ceres::CONVERGENCE: {
      if (summary.message.starts_with("Function tolerance")) return "cost no longer changes";
      if (summary.message.starts_with("Parameter tolerance")) return "parameters no longer change";
      if (summary.message.starts_with("Gradient tolerance")) return "gradient is zero";
      return "converged";
    }
    case ceres::NO_CONVERGENCE:
      return "iteration limit";
    default:
      return "failed: " + summary.message;
  }
}

// Minimises with the entries `held` standing still.
SolveReport minimise(Problem& problem, std::vector<double>& x, const SolveOptions& options,
                     const std::vector<int>& held) {
  SolveReport report;
  const int n = problem.size();
  bool broken = false;
  ceres::Problem ceres_problem;
  ceres_problem.AddParameterBlock(x.data(), n);
  ceres_problem.AddResidualBlock(new WholeProblem(problem, broken), nullptr, x.data());
  for (int i = 0; i < n; ++i)
    if (const auto& bounds = problem.quantity(i).bounds) {
      ceres_problem.SetParameterLowerBound(x.data(), i, bounds->first);
      ceres_problem.SetParameterUpperBound(x.data(), i, bounds->second);
      x[i] = std::clamp(x[i], bounds->first, bounds->second);
    }
  if (!held.empty()) ceres_problem.SetManifold(x.data(), new ceres::SubsetManifold(n, held));
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.gradient_tolerance = 1e-14;
  solver.initial_trust_region_radius = 1e6;
  solver.logging_type = ceres::SILENT;
  Creeping creeping(problem);
  solver.callbacks.push_back(&creeping);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  report.converged = !broken && (summary.termination_type == ceres::CONVERGENCE ||
                                 summary.termination_type == ceres::USER_SUCCESS);
  report.iterations = static_cast<int>(summary.iterations.size()) - 1;
  report.initial_cost = summary.initial_cost;
  report.final_cost = summary.IsSolutionUsable() && !broken
                          ? summary.final_cost
                          : std::numeric_limits<double>::infinity();
  report.seconds = summary.total_time_in_seconds;
  report.stopped = broken ? "failed: the model has no derivatives there" : words(summary);
  return report;
}

// The entries that lie at a bound which the cost pushes them against.
std::vector<int> pushed(Problem& problem, const std::vector<double>& x) {
  std::vector<int> at_bound;
  for (int i = 0; i < problem.size(); ++i)
    if (const auto& b = problem.quantity(i).bounds; b && (x[i] <= b->first || x[i] >= b->second))
      at_bound.push_back(i);
  if (at_bound.empty()) return at_bound;
  const Eigen::MatrixXd F = problem.normal(x).factor;
  const Eigen::VectorXd g = F.leftCols(problem.size()).transpose() * F.col(problem.size());
  std::erase_if(at_bound, [&](int i) {
    return x[i] <= problem.quantity(i).bounds->first ? g[i] <= 0 : g[i] >= 0;
  });
  return at_bound;
}

}  // namespace

SolveReport solve(Problem& problem, std::vector<double>& x, const SolveOptions& options) {
  SolveReport report;
  const int n = problem.size();
  report.initial_cost = report.final_cost = problem.cost(x);
  if (n == 0 || static_cast<int>(options.held.size()) == n) {
    report.converged = true;
    report.stopped = "nothing to solve for";
    return report;
  }
  if (!std::isfinite(report.initial_cost)) {
    report.final_cost = std::numeric_limits<double>::infinity();
    report.stopped = "the model cannot be evaluated at the start";
    return report;
  }
  // Ceres' steps are cut off at a bound one by one, which may end beside the minimum along it: what
  // is pushed against a bound is held there and the others are solved for again, until nothing more
  // changes.
  std::vector<int> held = options.held;
  for (int round = 0; round < 10; ++round) {
    const SolveReport next = minimise(problem, x, options, held);
    const int iterations = report.iterations + next.iterations;
    const double initial = report.initial_cost, seconds = report.seconds + next.seconds;
    report = next;
    report.iterations = iterations, report.initial_cost = initial, report.seconds = seconds;
    if (!std::isfinite(report.final_cost)) break;
    std::vector<int> now = options.held;
    for (int i : pushed(problem, x))
      if (std::find(now.begin(), now.end(), i) == now.end()) now.push_back(i);
    if (now == held || static_cast<int>(now.size()) == n) break;
    held = std::move(now);
  }
  return report;
}

}  // namespace talus
