#include "framework/calibration/problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "framework/calibration/gram.h"
#include "framework/calibration/parallel.h"
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
    if constexpr (std::is_same_v<std::decay_t<decltype(u)>, int>) slots.push_back(program.unknowns[u].slot);
    else slots.push_back(program.unknowns[u.unknown].slot);
  }
  return slots;
}

std::vector<int> noisy(const Program& program, const ProblemOptions& options) {
  std::vector<int> slots;
  if (options.propagate && !program.settings.weighted)
    for (const Reading& r : program.readings)
      if (r.sigma > 0) slots.push_back(r.slot);
  return slots;
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

Plan plan_for(const Program& program, const Groups& groups, const ProblemOptions& options) {
  const std::vector<int> latent = unknown_slots(program, groups.latent), shared = unknown_slots(program, groups.shared);
  return Plan(program, {joined(parameter_slots(program, options), shared), latent, noisy(program, options)}, joined(latent, shared));
}

Problem::Inside::Inside(const Program& p, Plan the_plan, const Recordings& recordings, const std::vector<std::size_t>& rows, const Groups& g,
                        const ProblemOptions& o)
    : program(p), options(o), groups(g), latent_slots(unknown_slots(p, g.latent)), shared_slots(unknown_slots(p, g.shared)),
      noisy_slots(noisy(p, o)), plan(std::move(the_plan)), data(p, plan, recordings, rows, g) {
  if (latent_slots.size() > 8) throw InputError("more than 8 unknowns per pose");
  for (int slot : noisy_slots)
    for (const Reading& r : p.readings)
      if (r.slot == slot) noise_variance.push_back(r.sigma * r.sigma);
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
    for (std::size_t u = 0; u < groups.shared.size(); ++u) occurs[offset[u] + data.batch(b).instance[u]] = true;
  for (int u : groups.latent) latent_prior.push_back(p.unknowns[u].start);
  const auto nl = latent_slots.size();
  latent.assign(std::max<std::size_t>(1, nl) * lanes * std::max(1, data.batches()), 0);
  for (int b = 0; b < data.batches(); ++b)
    for (std::size_t i = 0; i < nl; ++i) std::fill_n(&latent[(b * nl + i) * lanes], lanes, latent_prior[i].value);
  latent_trial = latent;
  for (const Row& row : p.rows) {
    const double unit = p.units.of(row.dimension).factor;
    row_factor.push_back(p.settings.weighted ? std::sqrt(row.weight) / unit : row.sigma ? 1 / *row.sigma : 1 / unit);
  }
  dense = !noisy_slots.empty();
  const int m = plan.rows(), widest = std::max({1, static_cast<int>(nl), static_cast<int>(noisy_slots.size())});
  const int batches_per_panel = std::max(1, 384 / (m * lanes));
  for (int t = 0; t < std::max(1, options.threads); ++t) {
    Bench& bench = benches.emplace_back();
    bench.workspace = plan.workspace();
    bench.state.resize(std::max<std::size_t>(1, plan.state().size()) * lanes);
    bench.whitened.resize(static_cast<std::size_t>(m) * lanes);
    bench.transform.resize(static_cast<std::size_t>(m) * m * lanes);
    bench.columns.resize(static_cast<std::size_t>(widest) * m * lanes);
    bench.panel.resize(static_cast<std::size_t>(padded(static_cast<int>(plan.columns(kGlobal).size()) + 1)) * batches_per_panel * m * lanes);
  }
  weights.assign(weight_block() * std::max(1, data.batches()), 0);
  fill_weights();
}

void Problem::Inside::fill_weights() {
  if (dense) return;
  for (int b = 0; b < data.batches(); ++b)
    for (int i = 0; i < rows() * lanes; ++i) weights[b * weight_block() + i] = data.mask(b)[i] * row_factor[i / lanes];
}

std::vector<double> Problem::Inside::slots(std::span<const double> x) const {
  std::vector<double> values(program.slots, 0);
  for (std::size_t i = 0; i < program.parameters.size(); ++i)
    values[program.parameters[i].slot] = options.only_unknowns ? held[i] : x[i];
  return values;
}

// Fixed chunks of batches: the same whatever the number of threads.
static int chunk_count(int batches, int size) { return std::clamp(batches / 4, 1, size > 200 ? 8 : 32); }

template <class F>  // f(bench, chunk, batch)
void Problem::Inside::each_batch(std::span<const double> x, F f) {
  const int chunks = chunk_count(data.batches(), size());
  const std::vector<double> values = slots(x);
  const int threads = data.batches() < 32 ? 1 : options.threads;
  for (int t = 0; t < std::max(1, threads); ++t) plan.set_parameters(benches[t].workspace, values);
  parallel_chunks(chunks, threads, [&](int chunk, int worker) {
    const int first = static_cast<int>(static_cast<long>(data.batches()) * chunk / chunks);
    const int last = static_cast<int>(static_cast<long>(data.batches()) * (chunk + 1) / chunks);
    for (int b = first; b < last; ++b) {
      load_state(benches[worker], b, x);
      f(benches[worker], chunk, b);
    }
  });
}

static double prior_cost(const std::vector<Quantity>& quantities, std::span<const double> x, double variance) {
  double sum = 0;
  for (std::size_t i = 0; i < quantities.size(); ++i)
    if (quantities[i].tolerance) sum += std::pow((x[i] - quantities[i].value) / *quantities[i].tolerance, 2);
  return variance * sum / 2;
}

// factor^T factor = [[H, g], [g^T, 2 cost]]: H by a pivoted LDL^T of the scaled matrix, so that a direction the data do not
// see gives a zero row rather than noise.
static Eigen::MatrixXd factor_of(const Eigen::MatrixXd& G, int n, double twice_cost) {
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale[i] = G(i, i) > 0 ? 1 / std::sqrt(G(i, i)) : 0;
  const Eigen::MatrixXd H = scale.asDiagonal() * Eigen::MatrixXd(G.topLeftCorner(n, n).selfadjointView<Eigen::Upper>()) * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(H);
  const Eigen::VectorXd d = ldlt.vectorD();
  const Eigen::MatrixXd L = ldlt.matrixL();
  Eigen::VectorXd y = ldlt.transpositionsP() * Eigen::VectorXd(scale.cwiseProduct(G.col(n).head(n)));
  L.triangularView<Eigen::UnitLower>().solveInPlace(y);
  Eigen::MatrixXd U = ldlt.transpositionsP().transpose() * L;  // H = U D U^T
  for (int i = 0; i < n; ++i) {
    const bool seen = d[i] > 1e-15 * n;
    const double root = seen ? std::sqrt(d[i]) : 0;
    F.row(i).head(n) = root * U.col(i).transpose();
    F(i, n) = seen ? y[i] / root : 0;
  }
  for (int i = 0; i < n; ++i)
    if (scale[i] > 0) F.col(i) /= scale[i];
  const double rest = twice_cost - F.col(n).head(n).squaredNorm();
  F(n, n) = rest > 0 ? std::sqrt(rest) : 0;
  return F;
}

Normal Problem::Inside::normal(std::span<const double> x, bool on, bool priors) {
  const int n = size(), m = rows(), local = static_cast<int>(plan.columns(kGlobal).size()), p = parameters();
  const int batches_per_panel = std::max(1, 384 / (m * lanes));
  const std::size_t block = static_cast<std::size_t>(m) * lanes, stride = block * batches_per_panel;
  const int chunks = chunk_count(data.batches(), n);
  struct Sum {
    Eigen::MatrixXd G, local;
    double cost = 0;
    int filled = 0;
    const std::vector<int>* instance = nullptr;
  };
  std::vector<Sum> sums(chunks);
  const bool direct = groups.shared.empty();
  auto flush = [&](Bench& bench, Sum& sum) {
    if (sum.filled == 0) return;
    if (sum.G.size() == 0) sum.G = Eigen::MatrixXd::Zero(n + 1, n + 1);
    const std::size_t length = block * sum.filled;
    if (direct) {
      (qr ? add_qr : add_gram)(bench.panel.data(), n + 1, stride, length, sum.G);
    } else {
      std::vector<int> to(local + 1);
      for (int i = 0; i < p; ++i) to[i] = i;
      for (int u = p; u < local; ++u) to[u] = offset[u - p] + (*sum.instance)[u - p];
      to[local] = n;
      sum.local.setZero(local + 1, local + 1);
      add_gram(bench.panel.data(), local + 1, stride, length, sum.local);
      for (int i = 0; i <= local; ++i)
        for (int j = i; j <= local; ++j) sum.G(std::min(to[i], to[j]), std::max(to[i], to[j])) += sum.local(i, j);
    }
    sum.filled = 0;
  };
  std::vector<int> last(chunks);
  for (int c = 0; c < chunks; ++c) last[c] = static_cast<int>(static_cast<long>(data.batches()) * (c + 1) / chunks) - 1;
  each_batch(x, [&](Bench& bench, int chunk, int b) {
    Sum& sum = sums[chunk];
    evaluate(bench, b);
    losses(bench, b, on);
    sum.cost += batch_cost(bench, b);
    const RowTransform t = transform(bench, b, on);
    if (sum.filled > 0 && sum.instance && *sum.instance != data.batch(b).instance) flush(bench, sum);
    sum.instance = &data.batch(b).instance;
    double* at = bench.panel.data() + sum.filled * block;
    plan.jacobian(bench.workspace, kGlobal, t, at, stride);
    std::memcpy(at + local * stride, bench.whitened.data(), block * sizeof(double));
    if (++sum.filled == batches_per_panel || b == last[chunk]) flush(bench, sum);
  });
  if (!latent_slots.empty()) latent = latent_trial;
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Normal result;
  const bool by_qr = qr && direct;
  for (const Sum& sum : sums) {
    result.cost += sum.cost;
    if (sum.G.size() == 0) continue;
    if (!by_qr) G += sum.G;
    else if (G.isZero(0)) G = sum.G;
    else {
      Buffer columns(static_cast<std::size_t>(n + 1) * (n + 1));
      std::copy(sum.G.data(), sum.G.data() + sum.G.size(), columns.begin());
      add_qr(columns.data(), n + 1, n + 1, n + 1, G);
    }
  }
  if (priors) result.cost += prior_cost(quantities, x, noise_variance_of_rows);
  if (by_qr) {
    if (priors) {
      Buffer rows_of_priors(static_cast<std::size_t>(n) * (n + 1), 0);
      for (int i = 0; i < n; ++i)
        if (quantities[i].tolerance) {
          const double weight = std::sqrt(noise_variance_of_rows) / *quantities[i].tolerance;
          rows_of_priors[static_cast<std::size_t>(i) * n + i] = weight;
          rows_of_priors[static_cast<std::size_t>(n) * n + i] = weight * (x[i] - quantities[i].value);
        }
      add_qr(rows_of_priors.data(), n + 1, n, n, G);
    }
    result.factor = G.triangularView<Eigen::Upper>();
    const double rest = 2 * result.cost - result.factor.col(n).head(n).squaredNorm();
    result.factor(n, n) = rest > 0 ? std::sqrt(rest) : 0;
    return result;
  }
  if (priors)
    for (int i = 0; i < n; ++i)
      if (quantities[i].tolerance) {
        const double t2 = *quantities[i].tolerance * *quantities[i].tolerance / noise_variance_of_rows;
        G(i, i) += 1 / t2;
        G(i, n) += (x[i] - quantities[i].value) / t2;
      }
  result.factor = factor_of(G, n, 2 * result.cost);
  return result;
}

Problem::Problem(const Program& program, const Recordings& recordings, const std::vector<std::size_t>& rows, const Groups& groups,
                 const ProblemOptions& options)
    : Problem(program, plan_for(program, groups, options), recordings, rows, groups, options) {}

Problem::Problem(const Program& program, const Plan& plan, const Recordings& recordings, const std::vector<std::size_t>& rows,
                 const Groups& groups, const ProblemOptions& options)
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
void Problem::set_noise_variance(double variance) { in_->noise_variance_of_rows = variance; }
void Problem::set_qr(bool on) { in_->qr = on && in_->groups.shared.empty(); }
bool Problem::qr() const { return in_->qr; }
const Dataset& Problem::data() const { return in_->data; }
const Groups& Problem::groups() const { return in_->groups; }
int Problem::rows() const { return in_->rows(); }
int Problem::latents() const { return static_cast<int>(in_->latent_slots.size()); }

void Problem::hold(const std::vector<double>& parameters) { in_->held = parameters; }

bool Problem::noise_known() const {
  return !in_->program.settings.weighted &&
         std::all_of(in_->program.rows.begin(), in_->program.rows.end(), [](const Row& r) { return r.sigma.has_value(); });
}

std::vector<std::string> Problem::names() const {
  std::vector<std::string> names;
  if (!in_->options.only_unknowns)
    for (const Parameter& p : in_->program.parameters) names.push_back(p.name);
  for (const auto& u : in_->groups.shared)
    for (const std::string& label : u.labels) names.push_back(in_->program.unknowns[u.unknown].name + "(" + label + ")");
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
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->plan.evaluate(bench.workspace, in_->data.data(b), bench.state.data());
    in_->combined_covariance(bench, b);
  });
}

double Problem::cost(std::span<const double> x) {
  std::vector<double> sums(chunk_count(in_->data.batches(), size()), 0.0);
  in_->each_batch(x, [&](Bench& bench, int chunk, int b) {
    in_->evaluate(bench, b);
    in_->losses(bench, b, in_->robust);
    sums[chunk] += in_->batch_cost(bench, b);
  });
  double total = in_->options.priors ? prior_cost(in_->quantities, x, in_->noise_variance_of_rows) : 0;
  for (double s : sums) total += s;
  return total;
}

Normal Problem::normal(std::span<const double> x) { return in_->normal(x, in_->robust, in_->options.priors); }
Normal Problem::information(std::span<const double> x) { return in_->normal(x, false, false); }

Problem::Residuals Problem::residuals(std::span<const double> x) {
  Residuals result;
  const int m = rows(), n = latents();
  std::vector<std::pair<std::size_t, std::pair<int, int>>> order;
  for (int b = 0; b < data().batches(); ++b)
    for (int l = 0; l < data().batch(b).count; ++l) order.push_back({static_cast<std::size_t>(data().batch(b).poses[l]), {b, l}});
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
        if (data().mask(b)[r * lanes + l] != 0) result.raw(at[b][l], r) = in_->plan.row(bench.workspace, r)[l];
      }
      for (int i = 0; i < n; ++i) result.latent(at[b][l], i) = bench.state[i * lanes + l];
    }
  });
  return result;
}

}  // namespace talus
