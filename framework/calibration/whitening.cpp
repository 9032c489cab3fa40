// The whitening of a pose's rows where their noise is that of readings and of measured columns.
#include <cmath>
#include <numeric>

#include "framework/calibration/problem_inside.h"

namespace talus {

// An order of the rows in which each has the largest share of its variance left that the rows
// before it do not explain: what follows from others comes last. (The third angle of a direction
// that lies in a plane of the axes tells it alone; the other two both measure the turn within that
// plane.)
static void pivot(const Eigen::MatrixXd& S, std::vector<int>& order) {
  std::iota(order.begin(), order.end(), 0);
  Eigen::MatrixXd left = S;
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto share = [&](int row) { return S(row, row) > 0 ? left(row, row) / S(row, row) : 0; };
    std::size_t best = i;  // of equal ones the first
    for (std::size_t k = i + 1; k < order.size(); ++k)
      if (share(order[k]) > share(order[best]) + 1e-12) best = k;
    std::swap(order[i], order[best]);
    const int row = order[i];
    if (!(left(row, row) > 0)) return;
    left -= (left.col(row) * left.row(row) / left(row, row)).eval();
  }
}

// L^-1 with L L^T = diag(sigma^2) + J_q diag(sigma_q^2) J_q^T + J_c C J_c^T: J_q the rows'
// derivatives by the readings, J_c those by measured columns whose covariance at this pose is C (of
// points, or of a frame whose rows follow from one another; sigma is 0 then). A row whose variance
// is nothing but a combination of those above it (the third angle of a direction) is left out and
// counted.
void Problem::Inside::combined_covariance(Bench& bench, int b, std::size_t& dependent) {
  const int m = rows(), nq = static_cast<int>(noisy_slots.size()),
            nc = static_cast<int>(noisy_columns.size()), nr = nq - nc;
  plan.jacobian(bench.workspace, kReadings, {}, bench.columns.data(),
                static_cast<std::size_t>(m) * lanes);
  double* out = &weights[b * weight_block()];
  const double* mask = data.mask(b);
  Eigen::MatrixXd S(m, m), C(nc, nc), J(m, nc), inverse(m, m);
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  for (int l = 0; l < lanes; ++l) {
    auto by = [&](int q, int row) {
      return bench.columns[(static_cast<std::size_t>(q) * m + row) * lanes + l];
    };
    auto used = [&](int row) { return mask[row * lanes + l] != 0; };
    for (int i = 0; i < m; ++i)
      for (int j = 0; j <= i; ++j) {
        const double own = by_columns[i] ? 0 : 1 / (row_factor[i] * row_factor[i]);
        double sum = i == j ? (used(i) ? own : 1) : 0;
        if (used(i) && used(j))
          for (int q = 0; q < nr; ++q) sum += by(q, i) * noise_variance[q] * by(q, j);
        S(i, j) = S(j, i) = sum;
      }
    if (nc > 0 && l < data.batch(b).count) {
      const auto& table = measured_noise->covariance[data.batch(b).poses[l]];
      const auto n = measured_noise->columns.size();
      for (int i = 0; i < nc; ++i)
        for (int j = 0; j < nc; ++j) C(i, j) = table[noisy_columns[i] * n + noisy_columns[j]];
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < nc; ++j) J(i, j) = used(i) ? by(nr + j, i) : 0;
      S.noalias() += J * C * J.transpose();
    }
    if (pivoted) {
      pivot(S, order);
      S = S(order, order).eval();
    }
    // Forward: row i of L and of its inverse.
    inverse.setZero();
    Eigen::MatrixXd& L = S;
    for (int i = 0; i < m; ++i) {
      const double variance = S(i, i);
      for (int j = 0; j < i; ++j) {
        double sum = S(i, j);
        for (int k = 0; k < j; ++k) sum -= L(i, k) * L(j, k);
        L(i, j) = L(j, j) > 0 ? sum / L(j, j) : 0;
      }
      double left = variance;
      for (int k = 0; k < i; ++k) left -= L(i, k) * L(i, k);
      if (!(left > (by_columns[order[i]] ? 1e-6 : 1e-12) * variance)) {
        L(i, i) = 0;
        if (used(order[i]) && l < data.batch(b).count) ++dependent;
        continue;
      }
      L(i, i) = std::sqrt(left);
      inverse(i, i) = 1 / L(i, i);
      for (int j = 0; j < i; ++j) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= L(i, k) * inverse(k, j);
        inverse(i, j) = sum / L(i, i);
      }
    }
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        out[(order[i] * m + order[j]) * lanes + l] = j <= i && used(order[i]) ? inverse(i, j) : 0;
  }
}

}  // namespace talus
