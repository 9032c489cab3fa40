#include "framework/calibration/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "framework/calibration/problem_inside.h"

namespace talus {

Problem::Problem(const Program& program, const Recordings& recordings,
                 const std::vector<std::size_t>& rows, const Groups& groups,
                 const ProblemOptions& options)
    : Problem(program, plan_for(program, groups, options), recordings, rows, groups, options) {}

Problem::Problem(const Program& program, const Plan& plan, const Recordings& recordings,
                 const std::vector<std::size_t>& rows, const Groups& groups,
                 const ProblemOptions& options)
    : in_(std::make_unique<Inside>(program, plan, recordings, rows, groups, options)) {
  in_->robust = options.robust;
  set_weights(in_->start);
}
Problem::~Problem() = default;
Problem::Problem(Problem&&) noexcept = default;

int Problem::size() const { return in_->size(); }
const std::vector<double>& Problem::start() const { return in_->start; }
const Quantity& Problem::quantity(int i) const { return in_->quantities[i]; }
Dimension Problem::dimension(int i) const { return in_->dimensions[i]; }
bool Problem::occurs(int i) const { return in_->occurs[i]; }
void Problem::set_robust(bool on) { in_->robust = on; }
Buffer Problem::latent_values() const { return in_->latent; }
void Problem::set_latent_values(const Buffer& values) { in_->latent = in_->latent_trial = values; }
double Problem::noise_variance() const { return in_->noise_variance_of_rows; }
void Problem::set_noise_variance(double variance) { in_->noise_variance_of_rows = variance; }
void Problem::set_mean_slope(double slope) { in_->mean_slope = slope; }
void Problem::set_qr(bool on) { in_->qr = on && in_->groups.shared.empty(); }
bool Problem::qr() const { return in_->qr; }
const Dataset& Problem::data() const { return in_->data; }
const Groups& Problem::groups() const { return in_->groups; }
int Problem::rows() const { return in_->rows(); }
int Problem::latents() const { return static_cast<int>(in_->latent_slots.size()); }

void Problem::hold(const std::vector<double>& parameters) { in_->held = parameters; }

bool Problem::noise_known() const {
  const std::vector<Row>& rows = in_->program.rows;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (!rows[r].sigma && !in_->by_columns[r]) return false;
  return !in_->program.settings.weighted;
}

std::vector<std::string> Problem::names() const {
  std::vector<std::string> names;
  if (!in_->options.only_unknowns)
    for (const Parameter& p : in_->program.parameters) names.push_back(p.name);
  for (const auto& u : in_->groups.shared)
    for (const std::string& label : u.labels)
      names.push_back(in_->program.unknowns[u.unknown].name + "(" + label + ")");
  return names;
}

bool Problem::whitening_depends_on_parameters() const { return in_->dense; }

void Problem::divide_rows_by(const std::vector<double>& scale) {
  for (int r = 0; r < rows(); ++r) {
    // The papers' weights are of dimensionless rows, so the unit goes out again.
    in_->row_factor[r] *= in_->program.units.of(in_->program.rows[r].dimension).factor;
    if (scale[r] > 0) in_->row_factor[r] /= scale[r];
  }
  in_->fill_weights();
}

void Problem::set_weights(std::span<const double> x) {
  if (!in_->dense) return;
  std::vector<std::size_t> dependent(in_->chunks(), 0);
  in_->each_batch(x, [&](Bench& bench, int chunk, int b) {
    in_->plan.evaluate(bench.workspace, in_->data.data(b), bench.state.data());
    in_->combined_covariance(bench, b, dependent[chunk]);
  });
  in_->dependent_rows = std::accumulate(dependent.begin(), dependent.end(), std::size_t{0});
}

std::size_t Problem::dependent_rows() const { return in_->dependent_rows; }

double Problem::cost(std::span<const double> x) {
  std::vector<double> sums(in_->chunks(), 0.0);
  in_->each_batch(x, [&](Bench& bench, int chunk, int b) {
    in_->evaluate(bench, b);
    in_->losses(bench, b, in_->robust);
    sums[chunk] += in_->batch_cost(bench, b);
  });
  double total = in_->options.priors ? in_->prior_cost(x) : 0;
  for (double s : sums) total += s;
  return total;
}

Normal Problem::normal(std::span<const double> x) {
  return in_->normal(x, in_->robust, in_->options.priors);
}
Normal Problem::information(std::span<const double> x) { return in_->normal(x, false, false); }

Problem::Residuals Problem::residuals(std::span<const double> x) {
  Residuals result;
  const int m = rows(), n = latents();
  std::vector<std::pair<std::size_t, std::pair<int, int>>> order;
  for (int b = 0; b < data().batches(); ++b)
    for (int l = 0; l < data().batch(b).count; ++l)
      order.push_back({static_cast<std::size_t>(data().batch(b).poses[l]), {b, l}});
  std::sort(order.begin(), order.end());
  std::vector<std::vector<int>> at(data().batches(), std::vector<int>(lanes));
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.poses.push_back(order[i].first);
    at[order[i].second.first][order[i].second.second] = static_cast<int>(i);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  result.raw.setConstant(static_cast<Eigen::Index>(order.size()), m, nan);
  result.whitened.setZero(static_cast<Eigen::Index>(order.size()), m);
  result.latent.setZero(static_cast<Eigen::Index>(order.size()), n);
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->evaluate(bench, b);
    for (int l = 0; l < data().batch(b).count; ++l) {
      for (int r = 0; r < m; ++r) {
        result.whitened(at[b][l], r) = bench.whitened[r * lanes + l];
        if (data().mask(b)[r * lanes + l] != 0)
          result.raw(at[b][l], r) = in_->plan.row(bench.workspace, r)[l];
      }
      for (int i = 0; i < n; ++i) result.latent(at[b][l], i) = bench.state[i * lanes + l];
    }
  });
  return result;
}

}  // namespace talus
