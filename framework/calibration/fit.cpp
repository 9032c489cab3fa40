#include "framework/calibration/fit.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

namespace talus {
namespace {

// Upper tail of chi-square by Wilson and Hilferty's cube root (good to a few per cent of p).
double chi2_tail(double chi2, double dof) {
  if (!(dof > 0)) return 1;
  const double v = 2 / (9 * dof);
  return 0.5 * std::erfc((std::cbrt(chi2 / dof) - (1 - v)) / std::sqrt(2 * v));
}

double rms(const Eigen::MatrixXd& whitened, const Eigen::MatrixXd& raw, const Problem& problem) {
  double sum = 0;
  std::size_t count = 0, dependent = problem.dependent_rows();
  for (Eigen::Index k = 0; k < raw.rows(); ++k)
    for (Eigen::Index r = 0; r < raw.cols(); ++r)
      if (!std::isnan(raw(k, r))) sum += whitened(k, r) * whitened(k, r), ++count;
  return count > dependent ? std::sqrt(sum / static_cast<double>(count - dependent))
                           : std::numeric_limits<double>::quiet_NaN();
}

// Least squares first, then the settings' loss or objective; the whitening is brought up to date in
// between.
SolveReport solve_in_stages(Problem& problem, std::vector<double>& x, const FitOptions& options,
                            bool robust, bool published) {
  SolveOptions solver;
  solver.max_iterations = options.max_iterations;
  problem.set_robust(false);
  // Without stated noise the tolerances have nothing to be weighed against but the residuals
  // themselves: first hardly at all, then in units of what the fit leaves.
  const double rows = std::max(1.0, static_cast<double>(problem.data().used()) - problem.size());
  auto estimate_noise = [&] {
    problem.set_noise_variance(std::max(1e-300, problem.information(x).cost * 2 / rows));
  };
  if (!problem.noise_known()) {
    problem.set_noise_variance(0);
    if (const double start = problem.cost(x); start > 0 && std::isfinite(start))
      problem.set_noise_variance(1e-6 * 2 * start / rows);
  }
  SolveReport total = solve(problem, x, solver);
  auto again = [&] {
    const SolveReport next = solve(problem, x, solver);
    total.iterations += next.iterations;
    total.seconds += next.seconds;
    total.final_cost = next.final_cost;
    total.converged = next.converged;
    total.stopped = next.stopped;
  };
  if (problem.whitening_depends_on_parameters()) {
    problem.set_weights(x);
    again();
  }
  if (!problem.noise_known() && std::isfinite(total.final_cost)) {
    estimate_noise();
    again();
  }
  if (robust) {
    if (published)
      problem.set_mean_slope(4 * problem.information(x).cost /
                             static_cast<double>(problem.data().poses()));
    problem.set_robust(true);
    again();
  }
  return total;
}

// The three parameters that differ most between two solutions, in words.
std::string differences(const Problem& problem, const std::vector<double>& x,
                        const std::vector<double>& other, const UnitSystem& units) {
  std::vector<int> order(x.size());
  std::iota(order.begin(), order.end(), 0);
  auto moved = [&](int i) {
    return std::abs(other[i] - x[i]) / typical_size(problem.quantity(i), problem.dimension(i));
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return moved(a) > moved(b); });
  const std::vector<std::string> names = problem.names();
  std::vector<std::string> words;
  for (int i : order) {
    const Unit unit = units.of(problem.dimension(i));
    words.push_back(fmt::format("{} {:.5g} instead of {:.5g} {}", names[i], other[i] / unit.factor,
                                x[i] / unit.factor, unit.text));
    if (words.size() == 3) break;
  }
  return join(words);
}

// Is the normal matrix so ill-conditioned that squaring loses what the data say, without being
// plainly singular?
bool wants_qr(Problem& problem, std::span<const double> x) {
  if (problem.size() == 0 || !problem.groups().shared.empty()) return false;
  const Eigen::MatrixXd F = problem.normal(x).factor;
  const auto n = F.cols() - 1;
  Eigen::MatrixXd J = F.leftCols(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (const double norm = J.col(i).norm(); norm > 0) J.col(i) /= norm;
  const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
  for (Eigen::Index i = 0; i < n; ++i)
    if (s[i] < 1e-6 * s[0] && s[i] > 1e-12 * s[0]) return true;
  return false;
}

}  // namespace

Fit calibrate(const Program& program, const Recordings& recordings, const Split& split,
              const FitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Fit fit;
  const Groups groups(program, recordings);
  ProblemOptions problem_options;
  problem_options.threads = options.threads;
  Problem problem(program, recordings, split.fit, groups, problem_options);
  const std::vector<double> fsr = full_scale_ranges(program, recordings);
  if (program.settings.full_scale) problem.divide_rows_by(fsr);
  if (problem.data().used() == 0)
    throw InputError({recordings.file, 0, 0}, "no row has all the values that a residual needs");
  const bool published = program.settings.objective == Objective::as_published,
             robust = published || program.settings.loss != LossKind::none;

  // From a start to a solution; each pose's own unknowns are tried from several starts of their
  // own.
  auto solve_from = [&](std::vector<double>& at) {
    problem.reset_latent_values();
    SolveReport found = solve_in_stages(problem, at, options, robust, published);
    if (problem.latents() > 0 && std::isfinite(found.final_cost)) {
      problem.scatter_latents(at, options.seed);
      if (problem.cost(at) < found.final_cost * (1 - 1e-9) - 1e-9) {
        const int before = found.iterations;
        found = solve_in_stages(problem, at, options, robust, published);
        found.iterations += before;
      }
    }
    return found;
  };
  std::vector<double> x = options.start.empty() ? problem.start() : options.start;
  problem.set_qr(options.solver == FitOptions::Solver::qr);
  if (options.solver == FitOptions::Solver::qr && !problem.qr())
    fit.warnings.push_back(
        "Unknowns shared by groups of rows are solved by normal equations; QR was not used.");
  SolveReport report = solve_from(x);
  if (!std::isfinite(report.final_cost))
    throw InputError({recordings.file, 0, 0},
                     "the model cannot be evaluated on these recordings: " + report.stopped,
                     "readings and nominal values for which every formula has a value (no triangle "
                     "that does not close)");
  if (options.solver == FitOptions::Solver::automatic && wants_qr(problem, x)) {
    problem.set_qr(true);
    const int before = report.iterations;
    report = solve_from(x);
    report.iterations += before;
  }

  // Other starts: the best minimum is taken, another one as good is reported.
  struct Solution {
    SolveReport report;
    std::vector<double> x;
    Buffer latent;
    double noise_variance;
  };
  std::vector<Solution> solutions;
  // Costs can be compared where the priors weigh the same.
  auto keep = [&](const SolveReport& found, const std::vector<double>& at) {
    solutions.push_back({found, at, problem.latent_values(), problem.noise_variance()});
    if (!problem.noise_known() && std::isfinite(found.final_cost))
      solutions.back().report.final_cost = problem.information(at).cost;
  };
  auto told = [&](int starts) {
    if (options.progress) options.progress(starts / (1.0 + options.restarts));
  };
  keep(report, x);
  told(1);
  std::size_t best = 0;
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  for (int k = 0; k < options.restarts; ++k) {
    std::vector<double> step(problem.start().size()), other = problem.start();
    for (std::size_t i = 0; i < step.size(); ++i) {
      const Quantity& q = problem.quantity(static_cast<int>(i));
      const double size = typical_size(q, problem.dimension(static_cast<int>(i)));
      step[i] = normal(random) * (q.tolerance ? size : 0.1 * size);
    }
    // Nearer, where the model has no value (a triangle that does not close).
    for (double scale = 1; scale > 0.01; scale /= 2) {
      for (std::size_t i = 0; i < step.size(); ++i) other[i] = problem.start()[i] + scale * step[i];
      if (std::isfinite(problem.cost(other))) break;
    }
    keep(solve_from(other), other);
    const double least = solutions[best].report.final_cost;
    if (solutions.back().report.final_cost < least - 1e-6 * least - 1e-9)
      best = solutions.size() - 1;
    told(k + 2);
  }
  x = solutions[best].x;
  problem.set_latent_values(solutions[best].latent);
  problem.set_noise_variance(solutions[best].noise_variance);
  report = solutions[best].report;
  const double per_row =
      report.final_cost / std::max<double>(1, static_cast<double>(problem.data().used()));
  const double scale = problem.noise_known() ? std::max(1.0, per_row) : std::max(1e-300, per_row);
  if (const double nominal = solutions[0].report.final_cost;
      report.final_cost < nominal - 0.5 * scale) {
    fit.better_start = fmt::format(
        "A scattered start reached a better minimum (cost {:.6g} instead of {:.6g}); the nominal "
        "values lead to a local one. The better one was taken.",
        report.final_cost, nominal);
    fit.warnings.push_back(fit.better_start);
  }
  problem.set_weights(x);
  const Eigen::MatrixXd J = problem.information(x).factor.leftCols(problem.size());
  for (const Solution& other : solutions) {
    if (!other.report.converged || other.report.final_cost > report.final_cost + 2 * scale)
      continue;
    Eigen::VectorXd step(problem.size());
    for (int i = 0; i < problem.size(); ++i) step[i] = other.x[i] - x[i];
    if ((J * step).squaredNorm() <= 100 * scale) continue;
    fit.twin =
        "Another set of parameters, far away, fits these recordings as well (a twin solution): " +
        differences(problem, x, other.x, program.units) +
        ". It may be the same linkage described otherwise (an axis reversed, two bars exchanged); "
        "if not, tighter "
        "tolerances or more varied poses would decide.";
    fit.warnings.push_back(fit.twin);
    break;
  }

  fit.x = x;
  fit.cost = report.final_cost;
  fit.iterations = report.iterations;
  fit.converged = report.converged;
  fit.stopped = report.stopped;
  fit.solver = problem.qr() ? "qr" : "gram";
  fit.poses_fit = split.fit.size();
  fit.poses_check = split.check.size();
  fit.rows_fit = problem.data().used();
  fit.noise_known = problem.noise_known();
  fit.residuals_fit = problem.residuals(x);
  fit.measures_fit = measures(program, fit.residuals_fit.raw, fsr);
  fit.fit_rms = rms(fit.residuals_fit.whitened, fit.residuals_fit.raw, problem);
  fit.chi2 = fit.residuals_fit.whitened.squaredNorm();
  fit.rows_missing = problem.data().missing();

  // Degrees of freedom: rows, less the unknowns of each pose, less what the parameters took.
  const double noise =
      problem.noise_known() ? 1 : std::sqrt(std::max(problem.noise_variance(), 1e-300));
  fit.seen = identify(problem, x, noise, program.units);
  const double rows = static_cast<double>(fit.rows_fit - problem.dependent_rows()),
               latent = problem.latent_freedom(x);
  fit.expected_rms = std::sqrt(std::max(0.0, 1 - latent / rows));
  fit.dof = rows - latent - fit.seen.effective;
  if (fit.dof < 0.5) {
    fit.warnings.push_back(fmt::format(
        "{} residuals for {:.0f} numbers that they determine: nothing is left to judge the fit by.",
        fit.rows_fit, latent + fit.seen.effective));
    fit.dof = 0;
  }
  fit.noise_scale = fit.dof > 0 && fit.chi2 > 0 ? std::sqrt(fit.chi2 / fit.dof) : 1;
  fit.chi2_p = fit.noise_known ? chi2_tail(fit.chi2, fit.dof) : 1;
  if (!fit.noise_known) {
    if (fit.dof > 0 && fit.chi2 > 0)
      fit.seen = identify(problem, x, fit.noise_scale, program.units);
    else
      fit.seen.std.setConstant(std::numeric_limits<double>::quiet_NaN());  // no noise to go by
    fit.fit_rms /= fit.noise_scale;
  }

  // Held-out rows: parameters stand, only what belongs to those rows alone is found.
  if (!split.check.empty()) {
    ProblemOptions check_options = problem_options;
    check_options.only_unknowns = true;
    Problem check(program, recordings, split.check, groups, check_options);
    if (program.settings.full_scale) check.divide_rows_by(fsr);
    const auto p = program.parameters.size();
    check.hold({x.begin(), x.begin() + static_cast<long>(p)});
    std::vector<double> y(x.begin() + static_cast<long>(p), x.end());
    SolveOptions held;
    for (int i = 0, u = 0; u < static_cast<int>(groups.shared.size()); ++u)
      for (int k = 0; k < groups.shared[u].instances; ++k, ++i) {
        const auto& of = groups.shared[u].instance;
        if (std::any_of(split.fit.begin(), split.fit.end(),
                        [&](std::size_t row) { return of[row] == k; }))
          held.held.push_back(i);
      }
    check.set_robust(false);
    check.set_weights(y);
    check.set_noise_variance(problem.noise_variance());
    check.scatter_latents(y, options.seed);
    if (!y.empty()) solve(check, y, held);
    fit.rows_missing += check.data().missing();
    fit.residuals_check = check.residuals(y);
    fit.measures_check = measures(program, fit.residuals_check.raw, fsr);
    fit.heldout_rms = rms(fit.residuals_check.whitened, fit.residuals_check.raw, check) /
                      (fit.noise_known ? 1 : fit.noise_scale);
    for (std::size_t i = 0; i < y.size(); ++i) x[p + i] = y[i];
    fit.x = x;
  } else {
    fit.heldout_rms = std::numeric_limits<double>::quiet_NaN();
  }

  const std::vector<std::string> names = problem.names();
  double farthest = 0;
  std::string far;
  for (int i = 0; i < problem.size(); ++i) {
    const Quantity& q = problem.quantity(i);
    FittedValue v{names[i],
                  problem.dimension(i),
                  q.value,
                  x[i],
                  fit.seen.std[i],
                  q.tolerance,
                  fit.seen.identifiable[i] && !std::isinf(fit.seen.std[i])};
    v.held_out = !problem.occurs(i);
    v.at_bound = q.bounds && (x[i] <= q.bounds->first || x[i] >= q.bounds->second);
    const double away = v.tolerance ? std::abs(v.value - v.nominal) / *v.tolerance : 0;
    if (away > 10 && away > farthest) farthest = away, far = v.name;
    if (v.at_bound) fit.warnings.push_back(fmt::format("{} ended at its bound.", v.name));
    (i < static_cast<int>(program.parameters.size()) ? fit.parameters : fit.shared)
        .push_back(std::move(v));
  }
  if (!far.empty())
    fit.warnings.push_back(
        fmt::format("{} ended {:.3g} tolerances from its nominal value: is a column, a unit, a "
                    "sign or the tolerance wrong?",
                    far, farthest));
  if (split.check.size() > 0 && fit.heldout_rms > 3 * fit.fit_rms)
    fit.warnings.push_back(
        fmt::format("The rows held out fit {:.3g} times worse than those fitted: bad rows among "
                    "them, or a model that does not carry over.",
                    fit.heldout_rms / fit.fit_rms));
  if (!fit.converged) fit.warnings.push_back("The solver did not converge: " + fit.stopped + ".");
  if (fit.noise_known && fit.chi2_p < 1e-3)
    fit.warnings.push_back(
        fmt::format("What is left is {:.3g} times the stated noise (chi-square {:.4g} on {:.0f} "
                    "degrees of freedom): the model "
                    "does not hold to that accuracy, and the standard uncertainties, which assume "
                    "that it does, are too small.",
                    fit.noise_scale, fit.chi2, fit.dof));
  fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace talus
