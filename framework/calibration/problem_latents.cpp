// Unknowns of each pose: their values, further starts, and the freedom they take.
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "framework/calibration/identifiability.h"
#include "framework/calibration/problem_inside.h"

namespace talus {

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

}  // namespace talus
