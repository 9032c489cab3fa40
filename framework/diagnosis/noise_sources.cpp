#include "framework/diagnosis/noise_sources.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace talus {
namespace {

// Chance of a false claim, over all sources; scores of few poses have tails beyond the normal
// distribution's, hence little.
constexpr double surely = 1e-5;
// Less than this is not worth a word.
constexpr double noticeable = 1.3;
// Information on a source's share (in units of its log variance) below which nothing can be told.
constexpr double least_information = 0.2;
constexpr std::size_t most_tried = 4;
// Standard deviations of the fourth power's sum by which tails are heavy even so.
constexpr double still_heavy = 4;

// The score of the source's share in standard deviations, the common scale being free: those of
// Gaussian noise, and those that are seen where heavy tails make it vary more.
struct Score {
  double gaussian = 0, seen = 0;
};

struct Group {
  std::string name;
  std::vector<int> sources;
  Score score = {};
};

// Each source, and the sources of one feature and dimension together.
std::vector<Group> groups_of(const Problem::Noise& noise) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < noise.sources.size(); ++i)
    groups.push_back({noise.sources[i].name, {static_cast<int>(i)}});
  for (std::size_t i = 0; i < noise.sources.size(); ++i) {
    const Problem::NoiseSource& first = noise.sources[i];
    if (first.feature < 0) continue;
    Group together;
    bool new_one = true;
    for (std::size_t j = 0; j < noise.sources.size(); ++j)
      if (noise.sources[j].feature == first.feature &&
          noise.sources[j].dimension == first.dimension) {
        new_one = new_one && j >= i;
        together.name += (together.name.empty() ? "" : ", ") + noise.sources[j].name;
        together.sources.push_back(static_cast<int>(j));
      }
    if (new_one && together.sources.size() > 1) groups.push_back(std::move(together));
  }
  return groups;
}

struct Shares {
  std::vector<Eigen::MatrixXd> own, rest;
};

Shares split(const Problem::Noise& noise, const Group& group) {
  Shares s;
  for (const auto& shares : noise.shares) {
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(shares[0].rows(), shares[0].cols()), rest = own;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const bool mine = std::find(group.sources.begin(), group.sources.end(),
                                  static_cast<int>(i)) != group.sources.end();
      (mine ? own : rest) += shares[i];
    }
    s.own.push_back(std::move(own));
    s.rest.push_back(std::move(rest));
  }
  return s;
}

Score score(const Shares& shares, const std::vector<Eigen::VectorXd>& rows) {
  double squares = 0, freedom = 0, u = 0, own = 0, own2 = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    squares += rows[k].squaredNorm();
    freedom += shares.own[k].trace() + shares.rest[k].trace();
  }
  if (!(squares > 0) || !(freedom > 0)) return {};
  const double scale = squares / freedom;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    own += shares.own[k].trace();
    own2 += shares.own[k].squaredNorm();
  }
  const double part = own / freedom, information = (own2 - part * own) / 2;
  if (!(information > least_information)) return {};
  double seen = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double all = rows[k].squaredNorm() / scale - (shares.own[k] + shares.rest[k]).trace(),
                 mine = rows[k].dot(shares.own[k] * rows[k]) / scale - shares.own[k].trace(),
                 beyond = (mine - part * all) / 2;
    u += beyond, seen += beyond * beyond;
  }
  return {u / std::sqrt(information), u / std::sqrt(std::max(information, seen))};
}

struct Estimate {
  double own = 1, rest = 1, log_likelihood = 0;
  bool heavy = false;  // tails remain
};

// Maximum likelihood by Fisher's scoring on the logarithms of both variances.
Estimate estimate(const Shares& shares, const std::vector<Eigen::VectorXd>& rows) {
  Eigen::Vector2d gamma(1, 1), best = gamma;
  double known = -std::numeric_limits<double>::infinity(), damping = 1;
  bool heavy = false;
  for (int step = 0; step < 60; ++step) {
    double likelihood = 0, fourth = 0, expected = 0;
    Eigen::Vector2d u = Eigen::Vector2d::Zero();
    Eigen::Matrix2d F = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Eigen::MatrixXd V[2] = {gamma[0] * shares.own[k], gamma[1] * shares.rest[k]};
      // The inverse where there is any variance.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(V[0] + V[1]);
      Eigen::VectorXd inverse = solver.eigenvalues();
      const double least = 1e-9 * inverse.maxCoeff();
      for (Eigen::Index i = 0; i < inverse.size(); ++i) {
        likelihood -= inverse[i] > least ? std::log(inverse[i]) / 2 : 0;
        inverse[i] = inverse[i] > least ? 1 / inverse[i] : 0;
      }
      const Eigen::MatrixXd C =
          solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
      const Eigen::VectorXd r = C * rows[k];
      const double square = rows[k].dot(r),
                   freedom = static_cast<double>((inverse.array() > 0).count());
      likelihood -= square / 2;
      fourth += square * square, expected += freedom * (freedom + 2);
      const Eigen::MatrixXd CV[2] = {C * V[0], C * V[1]};
      for (int i = 0; i < 2; ++i) {
        u[i] += (r.dot(V[i] * r) - CV[i].trace()) / 2;
        for (int j = 0; j < 2; ++j)
          F(i, j) += (CV[i].array() * CV[j].transpose().array()).sum() / 2;
      }
    }
    if (likelihood > known) {
      const bool settled = likelihood - known < 1e-9 * std::abs(likelihood);
      known = likelihood, best = gamma, damping = 1;
      heavy = fourth - expected > still_heavy * std::sqrt(8 * expected);
      if (settled) break;
    } else {
      damping /= 2;
      if (damping < 1e-3) break;
    }
    F.diagonal().array() += 1e-6;
    const Eigen::Vector2d move = (damping * F.ldlt().solve(u)).cwiseMax(-1.5).cwiseMin(1.5);
    gamma = (gamma.array().log() + move.array()).exp().cwiseMax(1e-8).cwiseMin(1e12);
  }
  return {best[0], best[1], known, heavy};
}

}  // namespace

std::optional<NoiseVerdict::Source> noisier_source(const Problem::Noise& noise,
                                                   const std::vector<Eigen::VectorXd>& rows) {
  std::vector<Group> groups = groups_of(noise);
  for (Group& g : groups) g.score = score(split(noise, g), rows);
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.score.gaussian > b.score.gaussian;
  });
  std::optional<NoiseVerdict::Source> found;
  double likeliest = 0;
  for (std::size_t i = 0; i < std::min(groups.size(), most_tried); ++i) {
    auto chance = [&](double z) {
      return static_cast<double>(groups.size()) * std::erfc(z / std::sqrt(2.0)) / 2;
    };
    if (chance(groups[i].score.gaussian) > surely) break;
    const Estimate e = estimate(split(noise, groups[i]), rows);
    const double p = chance(e.heavy ? groups[i].score.seen : groups[i].score.gaussian);
    if (p > surely) continue;
    if (e.own < noticeable * noticeable * e.rest || e.own < noticeable * noticeable) continue;
    if (found && e.log_likelihood <= likeliest) continue;
    likeliest = e.log_likelihood;
    found = NoiseVerdict::Source{groups[i].name, std::sqrt(e.own), std::sqrt(e.rest), p};
  }
  return found;
}

}  // namespace talus
