#include "framework/calibration/covariance.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace talus {

Covariance covariance(const Program& program, const Recordings& recordings, const Split& split,
                      const Fit& fit) {
  const Groups groups(program, recordings);
  Problem problem(program, recordings, split.fit, groups, {});
  if (program.settings.full_scale) problem.divide_rows_by(full_scale_ranges(program, recordings));
  problem.set_latents(fit.residuals_fit.latent);
  problem.set_weights(fit.x);
  const double noise = fit.noise_known ? 1 : fit.noise_scale;
  const int n = problem.size();

  // Scaled to a unit diagonal, so that no unit and no wide tolerance drowns the others.
  Eigen::MatrixXd factor = problem.information(fit.x).factor.leftCols(n) / noise;
  Eigen::MatrixXd H = factor.transpose() * factor;
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i)
    if (const auto& t = problem.quantity(i).tolerance) prior[i] = 1 / (*t * *t);
  H.diagonal() += prior;
  Eigen::VectorXd unit(n);
  for (int i = 0; i < n; ++i) unit[i] = H(i, i) > 0 ? 1 / std::sqrt(H(i, i)) : 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * H *
                                                             unit.asDiagonal());
  Covariance result;
  result.stated = Eigen::MatrixXd::Zero(n, n);
  result.unbounded.resize(n, 0);
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd v = unit.cwiseProduct(eigen.eigenvectors().col(k));
    if (eigen.eigenvalues()[k] > 1e-13 * n) {
      result.stated += v * v.transpose() / eigen.eigenvalues()[k];
    } else {
      result.unbounded.conservativeResize(n, result.unbounded.cols() + 1);
      result.unbounded.rightCols(1) = v.normalized();
    }
  }

  const Eigen::MatrixXd g = problem.scores(fit.x) / (noise * noise);
  const double rows = static_cast<double>(fit.rows_fit) - problem.latent_freedom(fit.x);
  const double spent = rows / std::max(1.0, rows - fit.seen.effective);
  Eigen::MatrixXd spread = spent * g.transpose() * g;
  spread.diagonal() += prior;
  result.observed = result.stated * spread * result.stated;

  result.latent_std.assign(problem.latents(), 0);
  if (problem.latents() == 0) return result;
  const auto information = problem.latent_information(fit.x);
  for (const Eigen::MatrixXd& each : information) {
    const Eigen::MatrixXd inverse = each.completeOrthogonalDecomposition().pseudoInverse();
    for (int i = 0; i < problem.latents(); ++i)
      result.latent_std[i] +=
          noise * noise * inverse(i, i) / static_cast<double>(information.size());
  }
  for (double& v : result.latent_std) v = std::sqrt(v);
  return result;
}

}  // namespace talus
