// The normal form of a problem: sums over all batches, and their factor.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "framework/calibration/gram.h"
#include "framework/calibration/problem_inside.h"

namespace talus {

double Problem::Inside::prior_cost(std::span<const double> x) const {
  double sum = 0;
  for (std::size_t i = 0; i < quantities.size(); ++i)
    if (quantities[i].tolerance)
      sum += std::pow((x[i] - quantities[i].value) / *quantities[i].tolerance, 2);
  return prior_weight() * sum / 2;
}

// factor^T factor = [[H, g], [g^T, 2 cost]]: H by a pivoted LDL^T of the scaled matrix, so that a
// direction the data do not see gives a zero row rather than noise.
static Eigen::MatrixXd factor_of(const Eigen::MatrixXd& G, int n, double twice_cost) {
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd scale(n);
  for (int i = 0; i < n; ++i) scale[i] = G(i, i) > 0 ? 1 / std::sqrt(G(i, i)) : 0;
  const Eigen::MatrixXd H = scale.asDiagonal() *
                            Eigen::MatrixXd(G.topLeftCorner(n, n).selfadjointView<Eigen::Upper>()) *
                            scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(H);
  const Eigen::VectorXd d = ldlt.vectorD();
  const Eigen::MatrixXd L = ldlt.matrixL();
  Eigen::VectorXd y =
      ldlt.transpositionsP() * Eigen::VectorXd(scale.cwiseProduct(G.col(n).head(n)));
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
  const int n = size(), m = rows(), local = static_cast<int>(plan.columns(kGlobal).size()),
            p = parameters();
  const int batches_per_panel = std::max(1, 384 / (m * lanes));
  const std::size_t block = static_cast<std::size_t>(m) * lanes, stride = block * batches_per_panel;
  const int chunk_count = chunks();
  struct Sum {
    Eigen::MatrixXd G, local;
    double cost = 0;
    int filled = 0;
    const std::vector<int>* instance = nullptr;
  };
  std::vector<Sum> sums(chunk_count);
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
        for (int j = i; j <= local; ++j)
          sum.G(std::min(to[i], to[j]), std::max(to[i], to[j])) += sum.local(i, j);
    }
    sum.filled = 0;
  };
  std::vector<int> last(chunk_count);
  for (int c = 0; c < chunk_count; ++c)
    last[c] = static_cast<int>(static_cast<long>(data.batches()) * (c + 1) / chunk_count) - 1;
  each_batch(x, [&](Bench& bench, int chunk, int b) {
    Sum& sum = sums[chunk];
    evaluate(bench, b);
    losses(bench, b, on);
    sum.cost += batch_cost(bench, b);
    const RowTransform t = transform(bench, b, on);
    if (sum.filled > 0 && sum.instance && *sum.instance != data.batch(b).instance)
      flush(bench, sum);
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
    if (!by_qr)
      G += sum.G;
    else if (G.isZero(0))
      G = sum.G;
    else {
      Buffer columns(static_cast<std::size_t>(n + 1) * (n + 1));
      std::copy(sum.G.data(), sum.G.data() + sum.G.size(), columns.begin());
      add_qr(columns.data(), n + 1, n + 1, n + 1, G);
    }
  }
  if (priors) result.cost += prior_cost(x);
  if (by_qr) {
    if (priors) {
      Buffer rows_of_priors(static_cast<std::size_t>(n) * (n + 1), 0);
      for (int i = 0; i < n; ++i)
        if (quantities[i].tolerance) {
          const double weight = std::sqrt(prior_weight()) / *quantities[i].tolerance;
          rows_of_priors[static_cast<std::size_t>(i) * n + i] = weight;
          rows_of_priors[static_cast<std::size_t>(n) * n + i] =
              weight * (x[i] - quantities[i].value);
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
        const double t2 = *quantities[i].tolerance * *quantities[i].tolerance / prior_weight();
        G(i, i) += 1 / t2;
        G(i, n) += (x[i] - quantities[i].value) / t2;
      }
  result.factor = factor_of(G, n, 2 * result.cost);
  return result;
}

}  // namespace talus
