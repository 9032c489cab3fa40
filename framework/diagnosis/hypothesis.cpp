#include "framework/diagnosis/hypothesis.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/calibration/parallel.h"
#include "framework/calibration/solve.h"

namespace talus {
namespace {

constexpr double kLoose = 100;  // amounts may be so many typical ones
constexpr double kStiff = 10;   // heights of a curve
constexpr std::size_t kMany = 3;

// In typical amounts. Many at once are held to the size that the rows speak for, where that is
// known.
double tolerance_of(const Accepted& e) {
  if (e.scale > 0 && e.way.amounts.size() > kMany) return e.scale;
  return e.suspect.effect == "unknown" ? kStiff : kLoose;
}

// Values at the entries of x: by name where known.
std::vector<double> start_of(const Problem& problem, const std::map<std::string, double>& values) {
  std::vector<double> x = problem.start();
  const std::vector<std::string> names = problem.names();
  for (std::size_t i = 0; i < x.size(); ++i)
    if (auto it = values.find(names[i]); it != values.end()) x[i] = it->second;
  return x;
}

// How the compiler calls the effect's element.
std::string owner_of(const Accepted& e) {
  const std::string& tag = e.suspect.plugin->declaration.tag;
  return e.suspect.at.empty() ? tag : tag + "_" + e.suspect.at;
}

// The problem of a compiled hypothesis and what it finds.
class Fitter {
 public:
  Fitter(const Ground& ground, std::vector<Accepted> effects, int threads) : ground_(&ground) {
    const Model whole = extended(*ground.model, effects, UnitSystem{});
    trial_.effects = std::move(effects);
    auto program = std::make_shared<Program>(compile(whole, *ground.registry));
    const Groups groups(*program, *ground.recordings);
    ProblemOptions options;
    options.threads = threads;
    options.robust = false;
    problem_ =
        std::make_unique<Problem>(*program, *ground.recordings, ground.rows, groups, options);
    if (!ground.scale.empty()) problem_->divide_rows_by(ground.scale);
    trial_.program = std::move(program);
  }

  // Root mean square of each row at these values, as Problem::divide_rows_by takes it.
  std::vector<double> scale(const Trial& at) {
    std::vector<double> result;
    if (problem_->noise_known()) return result;
    if (at.latents.size() > 0) problem_->set_latents(at.latents);
    const Eigen::MatrixXd rows = problem_->residuals(start_of(*problem_, at.values)).whitened;
    // A row that is fitted exactly must not outweigh the others.
    const double least = 1e-6 * std::sqrt(rows.squaredNorm() / static_cast<double>(rows.size()));
    for (Eigen::Index r = 0; r < rows.cols(); ++r) {
      const double rms = rows.col(r).norm() / std::sqrt(static_cast<double>(rows.rows()));
      const Unit unit = trial_.program->units.of(trial_.program->rows[r].dimension);
      result.push_back(std::max(rms, least) * unit.factor);
    }
    return result;
  }

  Trial run(const Trial& near, const TrialOptions& options) {
    problem_->set_robust(false);
    std::vector<double> x = solve_from(start_of(*problem_, near.values), near, options);
    if (options.from_nominal) {
      const double found = cost_;
      const bool converged = trial_.converged;
      const Buffer latent = problem_->latent_values();
      std::vector<double> nominal = problem_->start();
      const auto& parameters = trial_.program->parameters;
      for (const Accepted& e : trial_.effects)
        for (std::size_t i = 0; i < parameters.size(); ++i)
          if (parameters[i].element == owner_of(e)) nominal[i] = 0;
      const std::vector<double> other = solve_from(nominal, near, options);
      if (cost_ < found - 1e-6)
        x = other;
      else
        problem_->set_latent_values(latent), cost_ = found, trial_.converged = converged;
    }
    finish(x);
    return std::move(trial_);
  }

 private:
  std::vector<double> solve_from(std::vector<double> x, const Trial& near,
                                 const TrialOptions& options) {
    if (near.latents.size() > 0) problem_->set_latents(near.latents);
    problem_->set_weights(start_of(*problem_, near.values));
    SolveOptions solver;
    solver.max_iterations = options.max_iterations;
    solver.function_tolerance = 1e-9;
    solver.parameter_tolerance = 1e-10;
    const SolveReport report = solve(*problem_, x, solver);
    trial_.converged = report.converged;
    cost_ = report.final_cost;
    return x;
  }

  void finish(const std::vector<double>& x) {
    const std::vector<std::string> names = problem_->names();
    double loose = 0;
    trial_.x = x;
    for (std::size_t i = 0; i < x.size(); ++i) trial_.values[names[i]] = x[i];
    Eigen::VectorXd std;
    if (std::isfinite(cost_)) {
      const Eigen::MatrixXd F = problem_->normal(x).factor;
      const auto n = F.cols() - 1;
      const Eigen::MatrixXd H = F.leftCols(n).transpose() * F.leftCols(n);
      std = H.ldlt().solve(Eigen::MatrixXd::Identity(n, n)).diagonal().cwiseMax(0).cwiseSqrt();
    }
    const auto& parameters = trial_.program->parameters;
    for (Accepted& e : trial_.effects) {
      const std::string owner = owner_of(e);
      for (std::size_t a = 0; a < e.way.amounts.size(); ++a)
        for (std::size_t i = 0; i < parameters.size(); ++i)
          if (parameters[i].element == owner && parameters[i].attribute == e.way.amounts[a]) {
            e.amounts[a] = x[i];
            if (std.size() > 0) e.std[a] = std[static_cast<Eigen::Index>(i)];
            if (const auto& t = parameters[i].nominal.tolerance)
              loose += std::pow((x[i] - parameters[i].nominal.value) / *t, 2);
          }
    }
    trial_.cost2 =
        std::isfinite(cost_) ? 2 * cost_ - loose : std::numeric_limits<double>::infinity();
    trial_.chi2 = std::isfinite(cost_) ? 2 * problem_->information(x).cost : trial_.cost2;
    trial_.latents = problem_->residuals(x).latent;
  }

  const Ground* ground_;
  Trial trial_;
  std::unique_ptr<Problem> problem_;
  double cost_ = 0;
};

Trial values_of(const Ground& ground, const Fit& fit) {
  Trial at;
  for (const auto& all : {fit.parameters, fit.shared})
    for (const FittedValue& v : all) at.values[v.name] = v.value;
  if (fit.residuals_fit.poses.size() == ground.rows.size()) at.latents = fit.residuals_fit.latent;
  return at;
}

}  // namespace

Model extended(const Model& model, const std::vector<Accepted>& effects, const UnitSystem& units) {
  Model result = model;
  UnitSystem system = units;
  if (const Attribute* a = model.root.find("length")) system.length = *parse_unit(a->text);
  if (const Attribute* a = model.root.find("angle")) system.angle = *parse_unit(a->text);
  for (const Accepted& e : effects) {
    std::vector<AmountValue> amounts;
    for (std::size_t a = 0; a < e.amounts.size(); ++a)
      amounts.push_back({e.amounts[a], tolerance_of(e) * e.way.typical[a]});
    result.root.children.push_back(element_of(e.suspect, e.way, amounts, system));
  }
  return result;
}

std::vector<double> scale_of_rows(const Ground& ground, const Fit& fit) {
  return Fitter(ground, {}, ground.threads).scale(values_of(ground, fit));
}

Trial trial_of(const Ground& ground, const Fit& fit) {
  return Fitter(ground, {}, ground.threads).run(values_of(ground, fit), {});
}

Trial fit_trial(const Ground& ground, const std::vector<Accepted>& effects, const Trial& near,
                const TrialOptions& options) {
  return Fitter(ground, effects, ground.threads).run(near, options);
}

std::vector<Trial> fit_trials(const Ground& ground,
                              const std::vector<std::vector<Accepted>>& hypotheses,
                              const Trial& near, const TrialOptions& options) {
  std::vector<Fitter> fitters;  // plugins may be scripts: compiled one after the other
  for (const auto& effects : hypotheses) fitters.emplace_back(ground, effects, 1);
  std::vector<Trial> result(hypotheses.size());
  parallel_chunks(static_cast<int>(fitters.size()), ground.threads,
                  [&](int i, int) { result[i] = fitters[i].run(near, options); });
  return result;
}

}  // namespace talus
