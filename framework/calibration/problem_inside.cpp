// How a calibration problem is set up: which slots are what, and the memory of each thread.
#include "framework/calibration/problem_inside.h"

#include <algorithm>
#include <cmath>

#include "framework/calibration/carried_noise.h"
#include "framework/calibration/gram.h"

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

}  // namespace talus
