// Ceres minimises a problem. It is handed one residual block of n+1 rows: the triangular factor of
// the problem's normal matrix, which has the same cost, gradient and Gauss-Newton matrix as all
// rows of all poses. So Ceres stays the solver (trust region, bounds, stopping) and the time goes
// into evaluating poses.
#pragma once

#include <string>
#include <vector>

#include "framework/calibration/problem.h"

namespace talus {

struct SolveOptions {
  int max_iterations = 200;
  double function_tolerance = 1e-12;
  double parameter_tolerance = 1e-12;
  std::vector<int> held;  // entries of x that do not move
};

struct SolveReport {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0, final_cost = 0, seconds = 0;
  std::string stopped;
};

// Minimises from x, which receives the solution.
SolveReport solve(Problem& problem, std::vector<double>& x, const SolveOptions& options = {});

}  // namespace talus
