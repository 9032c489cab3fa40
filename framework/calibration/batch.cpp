// What happens to one batch of poses: rows whitened, latent unknowns, losses, row transforms.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "framework/calibration/problem_inside.h"

namespace talus {

// Priors are in units of the noise, which is 1 where it is stated.
double Problem::Inside::latent_tolerance(int i) const {
  return *latent_prior[i].tolerance / std::sqrt(noise_variance_of_rows);
}

RowTransform Problem::Inside::whitening(int b) const {
  return {dense ? RowTransform::Kind::dense : RowTransform::Kind::diagonal,
          &weights[b * weight_block()]};
}

void Problem::Inside::load_state(Bench& bench, int b, std::span<const double> x) const {
  const std::size_t nl = latent_slots.size();
  std::memcpy(bench.state.data(), &latent[b * std::max<std::size_t>(1, nl) * lanes],
              nl * lanes * sizeof(double));
  for (std::size_t u = 0; u < shared_slots.size(); ++u)
    std::fill_n(&bench.state[(nl + u) * lanes], lanes, x[offset[u] + data.batch(b).instance[u]]);
}

void Problem::Inside::whiten(Bench& bench, int b) {
  const int m = rows();
  const double *w = &weights[b * weight_block()], *mask = data.mask(b);
  std::fill_n(bench.squares, lanes, 0.0);
  for (int r = 0; r < m; ++r) {
    double* out = &bench.whitened[r * lanes];
    if (!dense) {
      const double* raw = plan.row(bench.workspace, r);
      for (int l = 0; l < lanes; ++l)
        out[l] = mask[r * lanes + l] != 0 ? raw[l] * w[r * lanes + l] : 0;
    } else {
      std::fill_n(out, lanes, 0.0);
      for (int q = 0; q < (pivoted ? m : r + 1); ++q) {
        const double *raw = plan.row(bench.workspace, q), *factor = w + (r * m + q) * lanes;
        for (int l = 0; l < lanes; ++l) out[l] += mask[q * lanes + l] != 0 ? factor[l] * raw[l] : 0;
      }
    }
    for (int l = 0; l < lanes; ++l) bench.squares[l] += out[l] * out[l];
  }
}

void Problem::Inside::evaluate(Bench& bench, int b) {
  plan.evaluate(bench.workspace, data.data(b), bench.state.data());
  whiten(bench, b);
  if (!latent_slots.empty()) solve_latent(bench, b);
}

// Levenberg-Marquardt per pose, all lanes in step: minimises |whitened rows|^2 + priors over the
// latent unknowns.
void Problem::Inside::solve_latent(Bench& bench, int b) {
  const int m = rows(), n = static_cast<int>(latent_slots.size()), count = data.batch(b).count;
  double cost[lanes], lambda[lanes] = {}, last_state[8 * lanes];
  bool done[lanes];
  auto prior = [&](int lane) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
      if (latent_prior[i].tolerance)
        sum += std::pow(
            (bench.state[i * lanes + lane] - latent_prior[i].value) / latent_tolerance(i), 2);
    return sum;
  };
  for (int l = 0; l < lanes; ++l) cost[l] = bench.squares[l] + prior(l), done[l] = l >= count;
  for (int iteration = 0; iteration < 60; ++iteration) {
    plan.jacobian(bench.workspace, kLatent, whitening(b), bench.columns.data(),
                  static_cast<std::size_t>(m) * lanes);
    std::memcpy(last_state, bench.state.data(), sizeof(double) * n * lanes);
    bool moved = false;
    for (int l = 0; l < count; ++l) {
      if (done[l]) continue;
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8> H(n, n);
      Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> g(n);
      for (int i = 0; i < n; ++i) {
        const double* ci = &bench.columns[static_cast<std::size_t>(i) * m * lanes + l];
        g[i] = 0;
        for (int r = 0; r < m; ++r) g[i] += ci[r * lanes] * bench.whitened[r * lanes + l];
        for (int j = 0; j <= i; ++j) {
          const double* cj = &bench.columns[static_cast<std::size_t>(j) * m * lanes + l];
          double sum = 0;
          for (int r = 0; r < m; ++r) sum += ci[r * lanes] * cj[r * lanes];
          H(i, j) = H(j, i) = sum;
        }
        if (latent_prior[i].tolerance) {
          const double t = latent_tolerance(i);
          H(i, i) += 1 / (t * t);
          g[i] += (bench.state[i * lanes + l] - latent_prior[i].value) / (t * t);
        }
      }
      // More unknowns than rows: the shortest move.
      const double least = n > m ? 1e-10 * H.diagonal().maxCoeff() : 0;
      for (int i = 0; i < n; ++i) H(i, i) += lambda[l] * H(i, i) + least + 1e-300;
      const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> move = -H.ldlt().solve(g);
      const double gain = -g.dot(move);
      if (!(gain > 1e-24 * cost[l]) || !move.allFinite()) {
        done[l] = true;
        continue;
      }
      for (int i = 0; i < n; ++i) {
        double& value = bench.state[i * lanes + l];
        value += move[i];
        if (const auto& bounds = latent_prior[i].bounds)
          value = std::clamp(value, bounds->first, bounds->second);
      }
      moved = true;
    }
    if (!moved) break;
    plan.evaluate(bench.workspace, data.data(b), bench.state.data());
    whiten(bench, b);
    bool rejected = false;
    for (int l = 0; l < count; ++l) {
      if (done[l]) continue;
      const double now = bench.squares[l] + prior(l);
      if (now <= cost[l]) {
        if (cost[l] - now <= 1e-13 * cost[l] && lambda[l] == 0) done[l] = true;
        cost[l] = now;
        lambda[l] = lambda[l] < 1e-6 ? 0 : lambda[l] / 10;
      } else {
        for (int i = 0; i < n; ++i) bench.state[i * lanes + l] = last_state[i * lanes + l];
        rejected = true;
        if (now <= cost[l] * (1 + 1e-12) || lambda[l] > 1e12) done[l] = true;
        lambda[l] = lambda[l] == 0 ? 1e-3 : lambda[l] * 10;
      }
    }
    if (rejected) {
      plan.evaluate(bench.workspace, data.data(b), bench.state.data());
      whiten(bench, b);
    }
    if (std::all_of(done, done + count, [](bool d) { return d; })) break;
  }
  std::memcpy(&latent_trial[static_cast<std::size_t>(b) * n * lanes], bench.state.data(),
              sizeof(double) * n * lanes);
}

// rho(s), rho'(s) and the curvature correction alpha (Triggs): rows become sqrt(rho') (I - alpha r
// r^T / s) J and sqrt(rho') / (1 - alpha) r. Huber and Cauchy act on s per row of the pose, so
// their scale is in sigmas.
void Problem::Inside::losses(Bench& bench, int b, bool on) {
  const CalibrationSettings& settings = program.settings;
  const double m = rows(), k2 = settings.loss_scale * settings.loss_scale;
  for (int l = 0; l < lanes; ++l) {
    const double s = bench.squares[l];
    double rho = s, rho1 = 1, alpha = 0;
    if (on && settings.objective == Objective::as_published) {
      rho = s * s, rho1 = 2 * s;
      alpha = 1 - std::sqrt(3.0);  // 1 + 2 s rho''/rho' = 3
    } else if (on && settings.loss == LossKind::huber && s > k2 * m) {
      rho = m * (2 * settings.loss_scale * std::sqrt(s / m) - k2);
      rho1 = settings.loss_scale / std::sqrt(s / m);
    } else if (on && settings.loss == LossKind::cauchy) {
      rho = m * k2 * std::log1p(s / (m * k2));
      rho1 = 1 / (1 + s / (m * k2));
    }
    bench.rho[l] = l < data.batch(b).count ? rho : 0;
    bench.rho1[l] = rho1, bench.alpha[l] = alpha;
  }
}

RowTransform Problem::Inside::transform(Bench& bench, int b, bool on) {
  const bool loss = on && (program.settings.objective == Objective::as_published ||
                           program.settings.loss != LossKind::none);
  const int m = rows(), n = static_cast<int>(latent_slots.size());
  if (!loss && n == 0) return whitening(b);
  if (n > 0)
    plan.jacobian(bench.workspace, kLatent, whitening(b), bench.columns.data(),
                  static_cast<std::size_t>(m) * lanes);
  const double* w = &weights[b * weight_block()];
  Eigen::MatrixXd& A = bench.A;
  Eigen::VectorXd &r = bench.r, &u = bench.u;
  Eigen::RowVectorXd& product = bench.product;
  for (int l = 0; l < lanes; ++l) {
    A.setZero();
    for (int i = 0; i < m; ++i) {
      r[i] = bench.whitened[i * lanes + l];
      if (dense)
        for (int j = 0; j < (pivoted ? m : i + 1); ++j) A(i, j) = w[(i * m + j) * lanes + l];
      else
        A(i, i) = w[i * lanes + l];
    }
    // Latent unknowns: those with a prior count as noise, those without are projected out.
    for (int pass = 0; pass < 2; ++pass)
      for (int i = 0; i < n; ++i) {
        if (bool(latent_prior[i].tolerance) != (pass == 0)) continue;
        for (int q = 0; q < m; ++q)
          u[q] = bench.columns[(static_cast<std::size_t>(i) * m + q) * lanes + l];
        if (pass == 0) {
          // (I + t^2 u u^T)^-1/2 = I - c u u^T, in the coordinates of what was done before.
          const double t2 = std::pow(latent_tolerance(i), 2);
          r -= u * (bench.state[i * lanes + l] - latent_prior[i].value);
          const double uu = u.squaredNorm(), c = uu > 0 ? (1 - 1 / std::sqrt(1 + t2 * uu)) / uu : 0;
          product.noalias() = u.transpose() * A;
          product *= c;
          A.noalias() -= u * product;
          r -= c * u * u.dot(r);
          for (int j = i + 1; j < n; ++j) {
            double* column = &bench.columns[static_cast<std::size_t>(j) * m * lanes + l];
            double dot = 0;
            for (int q = 0; q < m; ++q) dot += u[q] * column[q * lanes];
            for (int q = 0; q < m; ++q) column[q * lanes] -= c * u[q] * dot;
          }
        } else {
          const double before = u.norm();
          for (int j = 0; j < i; ++j) {
            if (latent_prior[j].tolerance) continue;
            double dot = 0;
            const double* e = &bench.columns[static_cast<std::size_t>(j) * m * lanes + l];
            for (int q = 0; q < m; ++q) dot += e[q * lanes] * u[q];
            for (int q = 0; q < m; ++q) u[q] -= dot * e[q * lanes];
          }
          const double norm = u.norm();
          if (norm > 1e-10 * before)
            u /= norm;
          else
            u.setZero();
          for (int q = 0; q < m; ++q)
            bench.columns[(static_cast<std::size_t>(i) * m + q) * lanes + l] = u[q];
          product.noalias() = u.transpose() * A;
          A.noalias() -= u * product;
          r -= u * u.dot(r);
        }
      }
    const double s = r.squaredNorm(), root = std::sqrt(bench.rho1[l]),
                 alpha = s > 0 ? bench.alpha[l] : 0;
    if (alpha != 0) {
      product.noalias() = r.transpose() * A;
      product *= alpha / s;
      A.noalias() -= r * product;
    }
    for (int i = 0; i < m; ++i) {
      bench.whitened[i * lanes + l] = root / (1 - alpha) * r[i];
      for (int j = 0; j < m; ++j) bench.transform[(i * m + j) * lanes + l] = root * A(i, j);
    }
  }
  return {RowTransform::Kind::dense, bench.transform.data()};
}

double Problem::Inside::batch_cost(const Bench& bench, int b) const {
  double sum = 0;
  for (int l = 0; l < data.batch(b).count; ++l) sum += bench.rho[l];
  const std::size_t n = latent_slots.size();
  for (std::size_t i = 0; i < n; ++i)
    if (latent_prior[i].tolerance)
      for (int l = 0; l < data.batch(b).count; ++l)
        sum +=
            std::pow((bench.state[i * lanes + l] - latent_prior[i].value) / latent_tolerance(i), 2);
  return sum / 2;
}

}  // namespace talus
