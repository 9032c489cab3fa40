#include "framework/diagnosis/stage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/calibration/load_columns.h"
#include "framework/diagnosis/tails.h"
#include "framework/kinematics/covariates.h"
#include "framework/kinematics/pose_values.h"

namespace talus {
namespace {

// A fit that the stated noise makes so unlikely is judged by what it leaves instead.
constexpr double kLogMisfit = -7;

// Poses before and after a change point, at least: fewer are blunders rather than a step.
constexpr int kLeastSide = 4;

Recorded recorded_in(const Recordings& recordings) {
  return [&recordings](const std::string& column) { return recordings.find(column) != nullptr; };
}

double number_of(const Recordings& recordings, const char* column, std::size_t row) {
  const RecordedColumn* c = recordings.find(column);
  return c && !std::isnan(c->values[row]) ? c->values[row] : static_cast<double>(row + 1);
}

// Of each pose its rank in the order of recording.
std::vector<int> order_in_time(const Recordings& recordings, const std::vector<std::size_t>& rows) {
  std::map<double, int> rank;
  for (std::size_t row : rows) rank[number_of(recordings, "pose", row)] = 0;
  int next = 0;
  for (auto& [pose, r] : rank) r = next++;
  std::vector<int> when;
  for (std::size_t row : rows) when.push_back(rank[number_of(recordings, "pose", row)]);
  return when;
}

PoseSlots slots_of(const Program& program, const Recordings& recordings, const Groups& groups,
                   std::span<const double> x, const std::vector<std::size_t>& rows,
                   const Eigen::MatrixXd& latents) {
  std::vector<PoseValues> chains;
  for (const Chain& chain : program.chains) chains.emplace_back(program, chain.motions);
  PoseSlots result;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::vector<double> slots(program.slots, 0);
    for (std::size_t i = 0; i < program.parameters.size(); ++i)
      slots[program.parameters[i].slot] = x[i];
    for (const Reading& r : program.readings)
      if (const RecordedColumn* c = recordings.find(r.column)) slots[r.slot] = c->values[rows[k]];
    for (const MeasuredColumn& m : program.columns)
      if (const RecordedColumn* c = recordings.find(m.name)) slots[m.slot] = c->values[rows[k]];
    for (std::size_t i = 0; i < groups.latent.size(); ++i)
      slots[program.unknowns[groups.latent[i]].slot] = latents(k, i);
    std::size_t at = program.parameters.size();
    for (const auto& u : groups.shared) {
      slots[program.unknowns[u.unknown].slot] = x[at + u.instance[rows[k]]];
      at += u.instances;
    }
    for (std::size_t c = 0; c < chains.size(); ++c)
      set_chain(program.chains[c], chains[c](slots), slots);
    result.push_back(std::move(slots));
  }
  return result;
}

}  // namespace

Recordings with_circumstances(const Model& model, const Registry& registry, const Program& program,
                              const Recordings& recordings, std::span<const double> x) {
  Recordings loaded = with_loads(program, recordings, x.first(program.parameters.size()));
  const Program fields = compile_with_fields(model, registry, recorded_in(loaded));
  return with_covariates(fields, std::move(loaded));
}

Linearised linearised(const Ground& ground, const Trial& trial, const StageOptions& options) {
  const Model whole = extended(*ground.model, trial.effects, UnitSystem{});
  auto compiled = std::make_shared<const Program>(
      compile_with_fields(whole, *ground.registry, recorded_in(*ground.recordings)));
  const Program& program = *compiled;
  const Groups groups(program, *ground.recordings);
  ProblemOptions problem_options;
  problem_options.threads = ground.threads;
  problem_options.robust = false;
  Problem problem(program, *ground.recordings, ground.rows, groups, problem_options);
  problem.set_robust(false);
  if (!ground.scale.empty()) problem.divide_rows_by(ground.scale);
  std::vector<double> x = problem.start();
  const std::vector<std::string> names = problem.names();
  for (std::size_t i = 0; i < x.size(); ++i)
    if (auto it = trial.values.find(names[i]); it != trial.values.end()) x[i] = it->second;
  if (trial.latents.size() > 0) problem.set_latents(trial.latents);
  problem.set_weights(x);
  const Problem::Linear linear = problem.linear(x);
  const Problem::Residuals residuals = problem.residuals(x);

  std::set<int> fields;
  for (const EffectPlace& place : program.places)
    for (int k = 0; k < parts_of(place.acts); ++k) fields.insert(place.first_field + k);
  std::vector<int> geometry, priors;
  for (int i = 0; i < problem.size(); ++i)
    if (!fields.contains(i)) {
      geometry.push_back(i);
      if (problem.quantity(i).tolerance) priors.push_back(static_cast<int>(geometry.size()) - 1);
    }
  Baseline base;
  const Eigen::Index n = linear.rows.size(), p = static_cast<Eigen::Index>(priors.size());
  base.rows.resize(n + p);
  base.rows.head(n) = linear.rows;
  base.columns = Eigen::MatrixXd::Zero(n + p, static_cast<Eigen::Index>(geometry.size()));
  base.columns.topRows(n) = linear.columns(Eigen::all, geometry);
  base.pose = linear.pose;
  for (Eigen::Index i = 0; i < p; ++i) {
    const int g = geometry[priors[i]];
    const double tolerance = *problem.quantity(g).tolerance;
    base.columns(n + i, priors[i]) = 1 / tolerance;
    base.rows[n + i] = (x[g] - problem.quantity(g).value) / tolerance;
    base.pose.push_back(-1);
  }
  base.taken = problem.latent_freedom(x) + static_cast<double>(problem.dependent_rows());

  const std::vector<int> when = order_in_time(*ground.recordings, residuals.poses);
  base.when = when;
  PoseSlots slots =
      slots_of(program, *ground.recordings, groups, x, residuals.poses, residuals.latent);
  Suspects found = suspects(program, *ground.registry, slots, linear, options.suspects);
  const int last = when.empty() ? 0 : *std::max_element(when.begin(), when.end());
  std::set<int> starts;  // of sessions, places in time
  std::map<int, double> session_at;
  for (std::size_t k = 0; k < when.size(); ++k)
    session_at[when[k]] = number_of(*ground.recordings, "session", residuals.poses[k]);
  for (auto it = session_at.begin(); it != session_at.end(); ++it)
    if (it != session_at.begin() && std::prev(it)->second != it->second) starts.insert(it->first);
  for (std::size_t f = 0; f < found.ways.size(); ++f) {
    Form& form = found.candidates.forms[f];
    const Suspect& s = found.suspects[found.ways[f].suspect];
    if (!form.onset) continue;
    if (s.plugin->declaration.effect.onset_of == Covariate::session)
      form.onsets.assign(starts.begin(), starts.end());
    else
      for (int w = kLeastSide; w <= last - kLeastSide + 1; ++w) form.onsets.push_back(w);
    if (form.onsets.empty()) form.onsets = {-1};  // nowhere
  }
  base.noise_known = options.noise_known && problem.noise_known();
  return {std::move(compiled), std::move(base),  std::move(found), linear.columns,
          std::move(slots),    residuals.latent, residuals.poses,  when,
          std::move(geometry)};
}

Stage stage_of(const Ground& ground, const Trial& trial, const StageOptions& options) {
  Linearised at = linearised(ground, trial, options);
  Baseline& base = at.baseline;
  Suspects& found = at.suspects;
  const Eigen::Index n = at.columns.rows();
  ScreenOptions screen_options;
  screen_options.threads = ground.threads;
  // By the stated noise first; where that makes the fit impossible, by what is left.
  Candidates candidates = std::move(found.candidates), none;
  none.columns.resize(n, 0);
  const Screen bare(base, none, screen_options);
  const double log_p = log_chi2_tail(bare.chi2(), bare.freedom());
  const bool studentised = !base.noise_known || log_p < kLogMisfit;
  const double p_value = base.noise_known ? std::exp(log_p) : 1;
  Screen screen(std::move(base), std::move(candidates), screen_options);
  return {std::move(found), std::move(screen), std::move(at.rows), std::move(at.when), bare.chi2(),
          bare.freedom(),   p_value,           studentised};
}

Accepted Stage::accepted(const Ground& ground, const Score& score) const {
  Accepted result;
  result.way = suspects.ways[score.pick.form];
  result.suspect = suspects.suspects[result.way.suspect];
  const EffectTraits& effect = result.suspect.plugin->declaration.effect;
  if (score.pick.from >= 0)
    for (std::size_t k = 0; k < when.size(); ++k)
      if (when[k] == score.pick.from)
        result.way.settings[effect.onset] =
            number_of(*ground.recordings,
                      effect.onset_of == Covariate::session ? "session" : "pose", rows[k]);
  for (std::size_t a = 0; a < result.way.amounts.size(); ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double estimate = score.estimate.size() > i ? score.estimate[i] : 0;
    const double most = 10 * result.way.typical[a];
    result.amounts.push_back(std::clamp(estimate, -most, most));
    result.std.push_back(score.std.size() > i ? score.std[i] : 0);
  }
  return result;
}

}  // namespace talus
