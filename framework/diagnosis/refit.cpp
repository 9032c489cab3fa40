#include "framework/diagnosis/refit.h"

#include <cmath>
#include <limits>

#include "framework/calibration/solve.h"

namespace talus {

Refit refit(Problem& problem, const std::vector<std::vector<double>>& starts,
            const RefitOptions& options) {
  SolveOptions solver;
  solver.max_iterations = options.max_iterations;
  Refit best;
  best.cost = std::numeric_limits<double>::infinity();
  Buffer latent = problem.latent_values();
  for (const auto& start : starts) {
    std::vector<double> x = start;
    problem.reset_latent_values();
    if (problem.latents() > 0 && options.scatter) problem.scatter_latents(x, options.seed);
    problem.set_weights(x);
    SolveReport report = solve(problem, x, solver);
    if (!std::isfinite(report.final_cost)) continue;
    if (problem.whitening_depends_on_parameters()) {
      problem.set_weights(x);
      report = solve(problem, x, solver);
    }
    if (!(report.final_cost < best.cost)) continue;
    best = {x, report.final_cost, 0, report.converged};
    latent = problem.latent_values();
  }
  problem.set_latent_values(latent);
  if (std::isfinite(best.cost)) {
    problem.set_weights(best.x);
    best.chi2 = 2 * problem.information(best.x).cost;
  }
  return best;
}

}  // namespace talus
