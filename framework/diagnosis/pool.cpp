#include "framework/diagnosis/pool.h"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

constexpr double kBearable = 3;  // times the loads that were recorded

// Without those that would load the linkage far more than it was, or would be with the other
// payloads and mountings: near a singular posture loads grow without bound, and nobody would go
// there.
std::vector<std::size_t> bearable(const Drawing& drawing, const Recordings& loaded,
                                  std::vector<std::size_t> rows) {
  const std::size_t recorded = loaded.rows() - drawing.drawn.size();
  std::vector<std::pair<const RecordedColumn*, double>> loads;
  for (const RecordedColumn& c : loaded.columns) {
    if (!c.name.starts_with("load:")) continue;
    double most = 0;
    for (std::size_t r = 0; r < loaded.rows(); ++r)
      if (std::isfinite(c.values[r]) && (r < recorded || drawing.at(r).origin.again >= 0))
        most = std::max(most, std::abs(c.values[r]));
    if (most > 0) loads.emplace_back(&c, kBearable * most);
  }
  for (std::size_t row = recorded; row < loaded.rows(); ++row)
    if (std::all_of(loads.begin(), loads.end(),
                    [&](const auto& l) { return std::abs(l.first->values[row]) <= l.second; }))
      rows.push_back(row);
  return rows;
}

// The unknowns of each pose, those of the drawn ones behind those of the fit.
Eigen::MatrixXd latents(const Drawing& drawing, const Program& program, const Groups& groups,
                        const Eigen::MatrixXd& fitted, const std::vector<std::size_t>& rows) {
  Eigen::MatrixXd all(static_cast<Eigen::Index>(rows.size()), fitted.cols());
  if (groups.latent.empty()) return fitted;
  all.topRows(fitted.rows()) = fitted;
  for (Eigen::Index k = fitted.rows(); k < all.rows(); ++k) {
    const auto& setting = drawing.at(rows[static_cast<std::size_t>(k)]).setting;
    for (std::size_t l = 0; l < groups.latent.size(); ++l)
      all(k, static_cast<Eigen::Index>(l)) =
          setting[program.readings.size() + static_cast<std::size_t>(groups.latent[l])];
  }
  return all;
}

}  // namespace

Pool pool_of(const Ground& ground, const Recordings& recordings, const Trial& null,
             const std::vector<double>& fit_x, const PoolOptions& options) {
  Program program = compile(*ground.model, *ground.registry);
  for (std::size_t i = 0; i < program.parameters.size(); ++i)
    program.parameters[i].nominal.value = fit_x[i];
  Drawing drawing = drawn_poses(ground, program, recordings, null, fit_x, options);
  Pool pool;
  pool.recordings =
      with_circumstances(*ground.model, *ground.registry, program, drawing.recordings, fit_x);
  const std::vector<std::size_t> rows = bearable(drawing, pool.recordings, ground.rows);
  Trial trial = null;
  trial.latents = latents(drawing, program, Groups(program, recordings), null.latents, rows);
  const Ground both{ground.model, ground.registry, &pool.recordings, rows, ground.threads};
  StageOptions stage;
  stage.suspects = options.suspects;
  Linearised at = linearised(both, trial, stage);

  const std::size_t recorded = recordings.rows();
  std::vector<int> old_rows, with_priors;
  std::vector<std::vector<int>> of_pose(at.rows.size());
  for (std::size_t r = 0; r < at.baseline.pose.size(); ++r) {
    const int pose = at.baseline.pose[r], row = static_cast<int>(r);
    if (pose < 0) {
      with_priors.push_back(row);
    } else if (at.rows[static_cast<std::size_t>(pose)] < recorded) {
      old_rows.push_back(row), with_priors.push_back(row);
    } else {
      of_pose[static_cast<std::size_t>(pose)].push_back(row);
    }
  }
  pool.recorded = at.rows;
  Baseline& b = pool.baseline;
  b.noise_known = at.baseline.noise_known;
  b.rows = at.baseline.rows(with_priors);
  b.columns = at.baseline.columns(with_priors, Eigen::all);
  for (const int r : with_priors) b.pose.push_back(at.baseline.pose[static_cast<std::size_t>(r)]);
  const double share =
      static_cast<double>(old_rows.size()) / static_cast<double>(at.columns.rows());
  b.taken = at.baseline.taken * share;
  const Eigen::MatrixXd& all = at.suspects.candidates.columns;
  for (std::size_t k = 0; k < of_pose.size(); ++k) {
    if (of_pose[k].empty()) continue;
    pool.poses.push_back(
        {at.baseline.columns(of_pose[k], Eigen::all), all(of_pose[k], Eigen::all)});
    pool.rows.push_back(at.rows[k]);
    pool.settings.poses.push_back(drawing.at(at.rows[k]).setting);
    pool.origins.push_back(drawing.at(at.rows[k]).origin);
  }
  const Eigen::MatrixXd old_columns = all(old_rows, Eigen::all);
  pool.suspects = std::move(at.suspects);
  pool.suspects.candidates.columns = old_columns;
  pool.coordinates = std::move(drawing.coordinates);
  pool.assumed = std::move(drawing.assumed);
  pool.mountings = std::move(drawing.mountings);
  pool.loops = std::move(drawing.loops);
  return pool;
}

}  // namespace talus
