// A plain least-squares fit: what a calibration does at its core, without judging. For the many
// fits to recordings changed a little.
#pragma once

#include <vector>

#include "framework/calibration/problem.h"

namespace talus {

struct Refit {
  std::vector<double> x;
  double cost = 0;  // priors included; infinite where the model has no value
  double chi2 = 0;  // of the rows alone
  bool converged = false;
};

struct RefitOptions {
  int max_iterations = 100;
  std::uint64_t seed = 1;
  bool scatter = true;  // try further starts of each pose's own unknowns
};

// The best of the solutions from these starts.
Refit refit(Problem& problem, const std::vector<std::vector<double>>& starts,
            const RefitOptions& options = {});

}  // namespace talus
