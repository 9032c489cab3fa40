#include "framework/diagnosis/fault_trials.h"

#include <algorithm>
#include <cmath>

#include "framework/diagnosis/refit.h"

namespace talus {
namespace {

// Enough for a quick fit, where columns are wrong by parts of their range.
constexpr std::size_t quick_rows = 60;

// Root mean square of what is left of each measure over its range.
double share_of_range(const Program& program, const Eigen::MatrixXd& raw, const Recordings& r) {
  double sum = 0;
  int count = 0;
  for (const Measure& m : measures(program, raw, full_scale_ranges(program, r)))
    if (std::isfinite(m.percent_fsr)) sum += std::pow(m.percent_fsr / 100, 2), ++count;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

double prior_squares(const Problem& problem, const std::vector<double>& x) {
  double sum = 0;
  for (int i = 0; i < problem.size(); ++i)
    if (const Quantity& q = problem.quantity(i); q.tolerance)
      sum += std::pow((x[i] - q.value) / *q.tolerance, 2);
  return sum;
}

FaultTrials::FaultTrials(const Program& program, const Recordings& recordings,
                         std::vector<std::size_t> rows, const FaultOptions& options)
    : program_(program), rows_(std::move(rows)), seed_(options.seed), groups_(program, recordings) {
  plain_.threads = options.threads;
  plain_.robust = false;
  plan_.emplace(plan_for(program, groups_, plain_));
  const std::size_t step = std::max<std::size_t>(1, rows_.size() / quick_rows);
  for (std::size_t k = 0; k < rows_.size(); k += step) few_.push_back(rows_[k]);
}

Problem FaultTrials::problem(const Recordings& r, const std::vector<std::size_t>& rows) const {
  Problem p(program_, *plan_, r, rows, groups_, plain_);
  if (program_.settings.full_scale) p.divide_rows_by(full_scale_ranges(program_, r));
  return p;
}

FaultTrial FaultTrials::of(const Recordings& r, const std::vector<std::size_t>& rows,
                           int iterations, bool thorough) {
  ++count;
  Problem p = problem(r, rows);
  const double freedom = static_cast<double>(p.data().used()) -
                         static_cast<double>(p.latents()) * static_cast<double>(p.data().poses());
  FaultTrial trial;
  if (!(freedom > 0)) return trial;
  if (!p.noise_known()) {
    const double start = p.cost(p.start());
    if (!std::isfinite(start)) return trial;
    p.set_noise_variance(1e-6 * 2 * start / freedom);  // tolerances hold what nothing tells
  }
  const Refit found =
      refit(p, {p.start()}, {.max_iterations = iterations, .seed = seed_, .scatter = thorough});
  if (!std::isfinite(found.cost)) return trial;
  // With priors: twice the cost of a right model is about its number of rows.
  trial.left = (p.noise_known() ? 2 * found.cost : found.chi2) / freedom;
  trial.rows = found.chi2 / freedom;
  trial.prior = prior_squares(p, found.x);
  if (thorough) trial.share = share_of_range(program_, p.residuals(found.x).raw, r);
  trial.x = found.x;
  return trial;
}

}  // namespace talus
