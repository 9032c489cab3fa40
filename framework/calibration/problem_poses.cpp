// What each pose of a problem says on its own: of the parameters, and of its latent unknowns.
#include <algorithm>

#include "framework/calibration/problem_inside.h"

namespace talus {

void Problem::set_latents(const Eigen::MatrixXd& values) {
  const std::size_t n = in_->latent_slots.size();
  for (int b = 0, k = 0; b < data().batches(); ++b)
    for (int l = 0; l < data().batch(b).count; ++l, ++k)
      for (std::size_t i = 0; i < n; ++i)
        in_->latent[(b * n + i) * lanes + l] = values(k, static_cast<Eigen::Index>(i));
  in_->latent_trial = in_->latent;
}

Eigen::MatrixXd Problem::scores(std::span<const double> x) {
  const int m = rows(), n = size();
  const std::size_t block = static_cast<std::size_t>(m) * lanes;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data().poses()), n);
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->evaluate(bench, b);
    in_->losses(bench, b, false);
    const RowTransform t = in_->transform(bench, b, false);
    in_->plan.jacobian(bench.workspace, Inside::kGlobal, t, bench.panel.data(), block);
    for (int l = 0; l < data().batch(b).count; ++l)
      for (int i = 0; i < n; ++i)
        for (int r = 0; r < m; ++r)
          result(b * lanes + l, i) +=
              bench.panel[i * block + r * lanes + l] * bench.whitened[r * lanes + l];
  });
  return result;
}

// Batches follow the groups; what comes back follows the recorded rows: of each lane its place.
std::vector<std::size_t> Problem::Inside::places() const {
  std::vector<std::pair<int, std::size_t>> order;  // recorded row, batch and lane
  for (int b = 0; b < data.batches(); ++b)
    for (int l = 0; l < data.batch(b).count; ++l)
      order.push_back({data.batch(b).poses[l], static_cast<std::size_t>(b) * lanes + l});
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> at(static_cast<std::size_t>(data.batches()) * lanes);
  for (std::size_t k = 0; k < order.size(); ++k) at[order[k].second] = k;
  return at;
}

Problem::Linear Problem::linear(std::span<const double> x) {
  const int m = rows(), p = in_->parameters(),
            local = static_cast<int>(in_->plan.columns(Inside::kGlobal).size());
  const std::size_t block = static_cast<std::size_t>(m) * lanes;
  const std::vector<std::size_t> at = in_->places();
  const auto poses = static_cast<Eigen::Index>(data().poses());
  Linear result;
  result.rows.resize(poses * m);
  result.columns = Eigen::MatrixXd::Zero(poses * m, size());
  result.pose.resize(data().poses() * m);
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->evaluate(bench, b);
    in_->losses(bench, b, false);
    const RowTransform t = in_->transform(bench, b, false);
    in_->plan.jacobian(bench.workspace, Inside::kGlobal, t, bench.panel.data(), block);
    for (int l = 0; l < data().batch(b).count; ++l)
      for (int r = 0; r < m; ++r) {
        const auto pose = static_cast<Eigen::Index>(at[static_cast<std::size_t>(b) * lanes + l]);
        const Eigen::Index row = pose * m + r;
        result.rows[row] = bench.whitened[r * lanes + l];
        result.pose[row] = static_cast<int>(pose);
        for (int j = 0; j < local; ++j)
          result.columns(row, j < p ? j : in_->offset[j - p] + data().batch(b).instance[j - p]) =
              bench.panel[j * block + r * lanes + l];
      }
  });
  return result;
}

std::vector<Eigen::MatrixXd> Problem::latent_information(std::span<const double> x) {
  const int m = rows(), n = latents();
  std::vector<Eigen::MatrixXd> result(data().poses(), Eigen::MatrixXd::Zero(n, n));
  if (n == 0) return result;
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->evaluate(bench, b);
    in_->plan.jacobian(bench.workspace, Inside::kLatent, in_->whitening(b), bench.columns.data(),
                       static_cast<std::size_t>(m) * lanes);
    auto entry = [&](int row, int column, int lane) {
      return bench.columns[(static_cast<std::size_t>(column) * m + row) * lanes + lane];
    };
    for (int l = 0; l < data().batch(b).count; ++l)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (int r = 0; r < m; ++r)
            result[b * lanes + l](i, j) += entry(r, i, l) * entry(r, j, l);
  });
  return result;
}

}  // namespace talus
