// Where the noise of a pose's rows comes from.
#include <cmath>

#include "framework/calibration/problem_inside.h"

namespace talus {

Problem::Noise Problem::noise(std::span<const double> x) {
  const Program& program = in_->program;
  const int m = rows(), all = static_cast<int>(in_->noisy_slots.size()),
            readings = all - static_cast<int>(in_->noisy_columns.size());
  Noise result;
  for (int q = 0; q < readings; ++q)
    for (const Reading& r : program.readings)
      if (r.slot == in_->noisy_slots[q])
        result.sources.push_back({r.sensor, -1, r.dimension, r.sigma});
  std::vector<int> source_of_row(m, -1);
  for (int r = 0; r < m; ++r)
    if (!in_->by_columns[r]) {
      source_of_row[r] = static_cast<int>(result.sources.size());
      const Row& row = program.rows[r];
      result.sources.push_back({row.measure, row.feature, row.dimension, row.sigma.value_or(0)});
    }
  // The noisy columns of each feature that has some.
  std::vector<std::vector<int>> columns_of;
  const std::size_t first_carried = result.sources.size();
  for (std::size_t f = 0; f < program.features.size(); ++f) {
    std::vector<int> own;
    for (int q = readings; q < all; ++q)
      for (int c : program.features[f].columns)
        if (program.columns[c].slot == in_->noisy_slots[q]) own.push_back(q);
    if (own.empty()) continue;
    columns_of.push_back(own);
    result.sources.push_back({program.features[f].name, static_cast<int>(f),
                              program.columns[program.features[f].columns[0]].dimension, 0});
  }
  result.shares.assign(data().poses(), std::vector<Eigen::MatrixXd>(result.sources.size(),
                                                                    Eigen::MatrixXd::Zero(m, m)));
  result.columns.assign(data().poses(),
                        Eigen::MatrixXd::Zero(m, static_cast<Eigen::Index>(result.sources.size())));
  const std::vector<std::size_t> at = in_->places();
  in_->each_batch(x, [&](Bench& bench, int, int b) {
    in_->evaluate(bench, b);
    in_->losses(bench, b, false);
    const RowTransform t = in_->transform(bench, b, false);
    if (all > 0)
      in_->plan.jacobian(bench.workspace, Inside::kReadings, t, bench.columns.data(),
                         static_cast<std::size_t>(m) * lanes);
    for (int l = 0; l < data().batch(b).count; ++l) {
      const std::size_t pose = at[static_cast<std::size_t>(b) * lanes + l];
      auto& shares = result.shares[pose];
      auto set = [&](int source, const Eigen::VectorXd& column) {
        result.columns[pose].col(source) = column;
        shares[source] = column * column.transpose();
      };
      auto by = [&](int q) {
        Eigen::VectorXd column(m);
        for (int r = 0; r < m; ++r)
          column[r] = bench.columns[(static_cast<std::size_t>(q) * m + r) * lanes + l];
        return column;
      };
      for (int q = 0; q < readings; ++q) set(q, std::sqrt(in_->noise_variance[q]) * by(q));
      for (int r = 0; r < m; ++r) {
        if (source_of_row[r] < 0 || data().mask(b)[r * lanes + l] == 0) continue;
        Eigen::VectorXd column = Eigen::VectorXd::Zero(m);
        if (t.kind == RowTransform::Kind::dense)
          for (int i = 0; i < m; ++i) column[i] = t.values[(i * m + r) * lanes + l];
        else
          column[r] = t.values[r * lanes + l];
        set(source_of_row[r], column / in_->row_factor[r]);
      }
      for (std::size_t f = 0; f < columns_of.size(); ++f) {
        const auto& table = in_->measured_noise->covariance[data().batch(b).poses[l]];
        const std::size_t n = in_->measured_noise->columns.size();
        auto place = [&](int q) {
          return static_cast<std::size_t>(in_->noisy_columns[q - readings]);
        };
        Eigen::MatrixXd& share = shares[first_carried + f];
        for (int i : columns_of[f])
          for (int j : columns_of[f])
            share += table[place(i) * n + place(j)] * by(i) * by(j).transpose();
      }
    }
  });
  return result;
}

}  // namespace talus
