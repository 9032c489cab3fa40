#include "framework/calibration/problem.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "framework/calibration/carried_noise.h"
#include "framework/calibration/gram.h"
#include "framework/calibration/identifiability.h"
#include "framework/calibration/problem_inside.h"

namespace talus {
namespace {

std::vector<int> parameter_slots(const Program& program, const ProblemOptions& options) {
  std::vector<int> slots;
  if (!options.only_unknowns)
    for (const Parameter& p : program.parameters) slots.push_back(p.slot);
  return slots;
}

template <class Indices>
std::vector<int> unknown_slots(const Program& program, const Indices& indices) {
  std::vector<int> slots;
  for (const auto& u : indices) {
    if constexpr (std::is_same_v<std::decay_t<decltype(u)>, int>)
      slots.push_back(program.unknowns[u].slot);
    else
      slots.push_back(program.unknowns[u.unknown].slot);
  }
  return slots;
}

// Data whose noise is carried to the rows: readings with a sigma, columns of features whose rows
// follow from one another, then what is probed.
std::vector<int> noisy(const Program& program, const ProblemOptions& options) {
  std::vector<int> slots;
  if (!options.propagate || program.settings.weighted) return slots;
  for (const Reading& r : program.readings)
    if (r.sigma > 0) slots.push_back(r.slot);
  for (const bool carried : {true, false})
    for (const Feature& f : program.features)
      if (carried ? f.carried : f.probed && !f.carried)
        for (int c : f.columns) slots.push_back(program.columns[c].slot);
  return slots;
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

Plan plan_for(const Program& program, const Groups& groups, const ProblemOptions& options) {
  const std::vector<int> latent = unknown_slots(program, groups.latent),
                         shared = unknown_slots(program, groups.shared);
  return Plan(program,
              {joined(parameter_slots(program, options), shared), latent, noisy(program, options)},
              joined(latent, shared));
}

Problem::Inside::Inside(const Program& p, Plan the_plan, const Recordings& recordings,
                        const std::vector<std::size_t>& rows, const Groups& g,
                        const ProblemOptions& o)
    : program(p),
      options(o),
      groups(g),
      latent_slots(unknown_slots(p, g.latent)),
      shared_slots(unknown_slots(p, g.shared)),
      noisy_slots(noisy(p, o)),
      plan(std::move(the_plan)),
      data(p, plan, recordings, rows, g) {
  if (latent_slots.size() > 8) throw InputError("more than 8 unknowns per pose");
  if (p.rows.empty()) throw InputError("the model has no residual: it measures nothing");
  carried = carried_noise(p, recordings);
  if (!carried.columns.empty())
    measured_noise = &carried;
  else
    measured_noise = recordings.noise.columns.empty() ? nullptr : &recordings.noise;
  for (int slot : noisy_slots) {
    for (const Reading& r : p.readings)
      if (r.slot == slot) noise_variance.push_back(r.sigma * r.sigma);
    for (const MeasuredColumn& c : p.columns) {
      if (c.slot != slot || !measured_noise) continue;
      const auto& known = measured_noise->columns;
      const auto at = std::find(known.begin(), known.end(), c.name);
      if (at != known.end()) noisy_columns.push_back(static_cast<int>(at - known.begin()));
    }
  }
  if (noise_variance.size() + noisy_columns.size() < noisy_slots.size())
    noisy_slots.resize(noise_variance.size() +
                       noisy_columns.size());  // probed features, but given as columns
  for (const Row& row : p.rows) {
    const std::vector<int>& columns = p.features[row.feature].columns;
    by_columns.push_back(!columns.empty() &&
                         std::find(noisy_slots.begin(), noisy_slots.end(),
                                   p.columns[columns[0]].slot) != noisy_slots.end());
  }
  pivoted = std::find(by_columns.begin(), by_columns.end(), true) != by_columns.end();
  for (const Parameter& parameter : p.parameters) held.push_back(parameter.nominal.value);
  if (!o.only_unknowns)
    for (const Parameter& parameter : p.parameters) {
      quantities.push_back(parameter.nominal);
      dimensions.push_back(parameter.dimension);
    }
  for (const auto& u : groups.shared) {
    offset.push_back(size());
    for (int i = 0; i < u.instances; ++i) {
      quantities.push_back(p.unknowns[u.unknown].start);
      dimensions.push_back(p.unknowns[u.unknown].dimension);
    }
  }
  for (const Quantity& q : quantities) start.push_back(q.value);
  occurs.assign(quantities.size(), groups.shared.empty());
  std::fill_n(occurs.begin(), parameters(), true);
  for (int b = 0; b < data.batches(); ++b)
    for (std::size_t u = 0; u < groups.shared.size(); ++u)
      occurs[offset[u] + data.batch(b).instance[u]] = true;
  for (int u : groups.latent) {
    latent_prior.push_back(p.unknowns[u].start);
    latent_dimensions.push_back(p.unknowns[u].dimension);
  }
  const auto nl = latent_slots.size();
  latent.assign(std::max<std::size_t>(1, nl) * lanes * std::max(1, data.batches()), 0);
  for (int b = 0; b < data.batches(); ++b)
    for (std::size_t i = 0; i < nl; ++i)
      std::fill_n(&latent[(b * nl + i) * lanes], lanes, latent_prior[i].value);
  latent_trial = latent;
  for (const Row& row : p.rows) {
    const double unit = p.units.of(row.dimension).factor;
    row_factor.push_back(p.settings.weighted ? std::sqrt(row.weight) / unit
                         : row.sigma         ? 1 / *row.sigma
                                             : 1 / unit);
  }
  dense = !noisy_slots.empty();
  const int m = plan.rows(), widest = std::max({1, static_cast<int>(nl),
                                                static_cast<int>(plan.columns(kReadings).size())});
  const int batches_per_panel = std::max(1, 384 / (m * lanes));
  for (int t = 0; t < std::max(1, options.threads); ++t) {
    Bench& bench = benches.emplace_back();
    bench.workspace = plan.workspace();
    bench.A.resize(m, m), bench.r.resize(m), bench.u.resize(m), bench.product.resize(m);
    bench.state.resize(std::max<std::size_t>(1, plan.state().size()) * lanes);
    bench.whitened.resize(static_cast<std::size_t>(m) * lanes);
    bench.transform.resize(static_cast<std::size_t>(m) * m * lanes);
    bench.columns.resize(static_cast<std::size_t>(widest) * m * lanes);
    bench.panel.resize(
        static_cast<std::size_t>(padded(static_cast<int>(plan.columns(kGlobal).size()) + 1)) *
        batches_per_panel * m * lanes);
  }
  weights.assign(weight_block() * std::max(1, data.batches()), 0);
  fill_weights();
}

void Problem::Inside::fill_weights() {
  if (dense) return;
  for (int b = 0; b < data.batches(); ++b)
    for (int i = 0; i < rows() * lanes; ++i)
      weights[b * weight_block() + i] = data.mask(b)[i] * row_factor[i / lanes];
}

std::vector<double> Problem::Inside::slots(std::span<const double> x) const {
  std::vector<double> values(program.slots, 0);
  for (std::size_t i = 0; i < program.parameters.size(); ++i)
    values[program.parameters[i].slot] = options.only_unknowns ? held[i] : x[i];
  return values;
}

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

void Problem::reset_latent_values() {
  const std::size_t n = in_->latent_slots.size();
  for (int b = 0; b < in_->data.batches(); ++b)
    for (std::size_t i = 0; i < n; ++i)
      std::fill_n(&in_->latent[(b * n + i) * lanes], lanes, in_->latent_prior[i].value);
  in_->latent_trial = in_->latent;
}

void Problem::scatter_latents(std::span<const double> x, std::uint64_t seed) {
  const std::size_t n = in_->latent_slots.size();
  if (n == 0) return;
  std::mt19937_64 random(seed);
  const Buffer start = in_->latent;
  Buffer best = start;
  std::vector<double> least(static_cast<std::size_t>(in_->data.batches()) * lanes);
  for (int attempt = 0; attempt < 8; ++attempt) {
    if (attempt > 0)
      for (std::size_t k = 0; k < in_->latent.size(); ++k) {
        const std::size_t i = k / lanes % n;
        const Quantity& q = in_->latent_prior[i];
        const double reach = in_->latent_dimensions[i] == angle
                                 ? 150 * deg
                                 : 3 * typical_size(q, in_->latent_dimensions[i]);
        double v = std::uniform_real_distribution<double>(q.value - reach, q.value + reach)(random);
        if (q.bounds) v = std::clamp(v, q.bounds->first, q.bounds->second);
        in_->latent[k] = v;
      }
    in_->each_batch(x, [&](Bench& bench, int, int b) {
      in_->evaluate(bench, b);
      for (int l = 0; l < lanes; ++l) {
        double& known = least[static_cast<std::size_t>(b) * lanes + l];
        // A clear gain only: equivalent branches (a turn more) are no reason to leave the first.
        if (attempt > 0 && !(bench.squares[l] < 0.99 * known - 1e-9)) continue;
        known = bench.squares[l];
        for (std::size_t i = 0; i < n; ++i)
          best[(b * n + i) * lanes + l] = bench.state[i * lanes + l];
      }
    });
  }
  set_latent_values(best);
}

double Problem::latent_freedom(std::span<const double> x) {
  const int n = latents(), m = rows();
  if (n == 0) return 0;
  std::vector<double> sums(in_->chunks(), 0.0);
  in_->each_batch(x, [&](Bench& bench, int chunk, int b) {
    in_->evaluate(bench, b);
    in_->plan.jacobian(bench.workspace, Inside::kLatent, in_->whitening(b), bench.columns.data(),
                       static_cast<std::size_t>(m) * lanes);
    for (int l = 0; l < data().batch(b).count; ++l) {
      Eigen::MatrixXd J(m, n);
      for (int i = 0; i < n; ++i)
        for (int r = 0; r < m; ++r)
          J(r, i) = bench.columns[(static_cast<std::size_t>(i) * m + r) * lanes + l];
      // trace of J (J^T J + P)^-1 J^T, P the priors' information.
      Eigen::MatrixXd H = J.transpose() * J;
      const Eigen::MatrixXd information = H;
      for (int i = 0; i < n; ++i) {
        if (in_->latent_prior[i].tolerance) H(i, i) += std::pow(in_->latent_tolerance(i), -2);
      }
      sums[chunk] += H.completeOrthogonalDecomposition().solve(information).trace();
    }
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

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
