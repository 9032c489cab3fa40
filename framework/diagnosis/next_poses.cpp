#include "framework/diagnosis/next_poses.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "framework/calibration/parallel.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Holds directions that nothing has seen yet, in columns of unit length.
constexpr double ridge = 1e-10;
constexpr double least_ratio = 1e-9;
constexpr int sweeps = 3;

struct Pair {
  std::vector<int> columns;                 // of the candidates in use
  VectorXd amounts;                         // in typical ones; empty: any direction
  std::vector<std::vector<int>> of_rivals;  // their columns
};

struct Chi2 {
  double seen = 0, told = 0;
};

// A design: what its poses say, with everything in units of the noise and of typical amounts.
struct Design {
  MatrixXd inverse;   // of J^T J
  MatrixXd absorbed;  // C: what each candidate moves in the geometry
  MatrixXd products;  // X~^T X~

  // The rows that a pose adds to X~.
  MatrixXd gain(const MatrixXd& J, const MatrixXd& X) const {
    const MatrixXd S = MatrixXd::Identity(J.rows(), J.rows()) + J * inverse * J.transpose();
    return S.llt().matrixL().solve(X - J * absorbed);
  }
  void add(const MatrixXd& J, const MatrixXd& X) {
    const MatrixXd S = MatrixXd::Identity(J.rows(), J.rows()) + J * inverse * J.transpose();
    const Eigen::LLT<MatrixXd> factor(S);
    const MatrixXd rest = X - J * absorbed;
    const MatrixXd half = factor.matrixL().solve(rest);
    const MatrixXd seen = inverse * J.transpose();
    const MatrixXd weight = factor.solve(seen.transpose());
    products.noalias() += half.transpose() * half;
    absorbed.noalias() += weight.transpose() * rest;
    inverse.noalias() -= seen * weight;
  }
};

double energy(const MatrixXd& products, const VectorXd& amounts) {
  if (amounts.size() == 0) return products.trace() / static_cast<double>(products.rows());
  return amounts.dot(products * amounts);
}

// With the rows F added.
Chi2 chi2(const Design& design, const MatrixXd& F, const Pair& pair, double reach) {
  auto block = [&](const std::vector<int>& a, const std::vector<int>& b) {
    MatrixXd m = design.products(a, b);
    if (F.rows() > 0) m += F(Eigen::all, a).transpose().lazyProduct(F(Eigen::all, b));
    return m;
  };
  const MatrixXd own = block(pair.columns, pair.columns);
  Chi2 result;
  result.seen = result.told = energy(own, pair.amounts);
  for (const auto& rival : pair.of_rivals) {
    MatrixXd theirs = block(rival, rival);
    theirs.diagonal().array() += 1 / (reach * reach);
    const MatrixXd between = block(rival, pair.columns);
    const MatrixXd left = own - between.transpose() * theirs.llt().solve(between);
    result.told = std::min(result.told, std::max(0.0, energy(left, pair.amounts)));
  }
  return result;
}

class Choice {
 public:
  Choice(const Baseline& baseline, const Candidates& candidates, const std::vector<PoolPose>& pool,
         const std::vector<Target>& targets, const NextPosesOptions& options);
  NextPoses choose();

 private:
  double ratio(const Chi2& c, std::size_t target) const {
    const double seen = c.seen / options_.seen;
    if (pairs_[target].of_rivals.empty()) return seen;
    return std::min(seen, c.told / options_.told);
  }
  // What is to be made small: the worst off count most.
  double want(const Design& design, const MatrixXd& F) const {
    double sum = 0;
    for (const std::size_t t : wanted_)
      sum += 1 / std::max(least_ratio, ratio(chi2(design, F, pairs_[t], options_.reach), t));
    return sum;
  }
  // The pose of the pool that helps most, and what is then wanted.
  std::pair<int, double> best(const Design& design, const std::vector<int>& taken) const;
  Design with(const std::vector<int>& chosen, std::size_t without) const;

  NextPosesOptions options_;
  std::vector<PoolPose> pool_;  // scaled, candidates in use only
  std::vector<Pair> pairs_;
  std::vector<std::size_t> wanted_;
  Design start_;
};

Choice::Choice(const Baseline& baseline, const Candidates& candidates,
               const std::vector<PoolPose>& pool, const std::vector<Target>& targets,
               const NextPosesOptions& options)
    : options_(options), pool_(pool) {
  std::vector<int> used, where(candidates.columns.cols(), -1);
  auto use = [&](int form) {
    std::vector<int> columns;
    for (const int c : candidates.forms.at(form).columns) {
      if (where[c] < 0) {
        where[c] = static_cast<int>(used.size());
        used.push_back(c);
      }
      columns.push_back(where[c]);
    }
    return columns;
  };
  for (const Target& t : targets) {
    Pair pair{.columns = use(t.form)};
    if (t.amounts.size() > 0)
      pair.amounts = t.amounts.cwiseQuotient(candidates.typical(candidates.forms[t.form].columns));
    for (const int r : t.rivals) pair.of_rivals.push_back(use(r));
    pairs_.push_back(std::move(pair));
  }

  double sigma = 1;
  const Index data = candidates.columns.rows();
  if (!baseline.noise_known) {
    const Screen left(baseline, {.columns = MatrixXd(data, 0), .typical = VectorXd(0)});
    sigma = std::sqrt(left.chi2() / std::max(1.0, left.freedom()));
  }
  VectorXd size = baseline.columns.colwise().squaredNorm();
  for (const PoolPose& p : pool) {
    if (p.columns.cols() != baseline.columns.cols() ||
        p.candidates.cols() != candidates.columns.cols())
      throw std::logic_error("a pose of the pool has other columns than the recorded ones");
    size += p.columns.colwise().squaredNorm();
  }
  size = size.unaryExpr([](double s) { return s > 0 ? 1 / std::sqrt(s) : 1; });
  const VectorXd typical = candidates.typical(used) / sigma;
  for (PoolPose& p : pool_) {
    p.candidates = MatrixXd(p.candidates(Eigen::all, used)) * typical.asDiagonal();
    p.columns = p.columns * size.asDiagonal();
  }
  const MatrixXd J = baseline.columns * size.asDiagonal();
  const MatrixXd X = MatrixXd(candidates.columns(Eigen::all, used)) * typical.asDiagonal();
  MatrixXd H = J.transpose() * J;
  H.diagonal().array() += ridge;
  start_.inverse = H.llt().solve(MatrixXd::Identity(J.cols(), J.cols()));
  start_.absorbed = start_.inverse * (J.topRows(data).transpose() * X);
  MatrixXd rest = -J * start_.absorbed;
  rest.topRows(data) += X;
  start_.products = rest.transpose() * rest;
}

std::pair<int, double> Choice::best(const Design& design, const std::vector<int>& taken) const {
  const auto count = static_cast<int>(pool_.size());
  std::vector<double> wants(count, INFINITY);
  constexpr int together = 16;
  parallel_chunks((count + together - 1) / together, options_.threads, [&](int chunk, int) {
    for (int i = chunk * together; i < std::min(count, (chunk + 1) * together); ++i)
      if (std::find(taken.begin(), taken.end(), i) == taken.end())
        wants[i] = want(design, design.gain(pool_[i].columns, pool_[i].candidates));
  });
  const auto least = std::min_element(wants.begin(), wants.end());
  return {static_cast<int>(least - wants.begin()), *least};
}

Design Choice::with(const std::vector<int>& chosen, std::size_t without) const {
  Design design = start_;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (i != without) design.add(pool_[chosen[i]].columns, pool_[chosen[i]].candidates);
  return design;
}

NextPoses Choice::choose() {
  NextPoses result;
  result.targets.resize(pairs_.size());
  std::vector<int> everything(pool_.size());
  std::iota(everything.begin(), everything.end(), 0);
  const Design whole = with(everything, everything.size());
  const MatrixXd none;
  for (std::size_t t = 0; t < pairs_.size(); ++t) {
    TargetGain& gain = result.targets[t];
    const Chi2 now = chi2(start_, none, pairs_[t], options_.reach);
    gain.seen_before = now.seen;
    gain.told_before = now.told;
    gain.attainable = ratio(chi2(whole, none, pairs_[t], options_.reach), t) >= 1;
    if (gain.attainable) wanted_.push_back(t);
  }
  Design design = start_;
  const auto count = std::min<std::size_t>(std::max(0, options_.count), pool_.size());
  if (!wanted_.empty()) {
    double wanted = want(design, none);
    while (result.chosen.size() < count) {
      const auto [pose, left] = best(design, result.chosen);
      result.chosen.push_back(pose);
      design.add(pool_[pose].columns, pool_[pose].candidates);
      wanted = left;
    }
    bool better = true;
    for (int sweep = 0; better && sweep < sweeps; ++sweep) {
      better = false;
      for (std::size_t i = 0; i < result.chosen.size(); ++i) {
        const auto [pose, left] = best(with(result.chosen, i), result.chosen);
        if (!(left < wanted * (1 - 1e-6))) continue;
        result.chosen[i] = pose;
        wanted = left;
        better = true;
      }
    }
    design = with(result.chosen, result.chosen.size());
  }
  for (std::size_t i = 0; i < result.chosen.size(); ++i) {
    const Design less = with(result.chosen, i);
    auto& loss = result.loss.emplace_back(pairs_.size(), 0);
    for (const std::size_t t : wanted_) {
      const double all = chi2(design, none, pairs_[t], options_.reach).told;
      if (all > 0) loss[t] = 1 - chi2(less, none, pairs_[t], options_.reach).told / all;
    }
  }
  result.before = result.after = wanted_.empty() ? 0 : INFINITY;
  for (std::size_t t = 0; t < pairs_.size(); ++t) {
    TargetGain& gain = result.targets[t];
    const Chi2 then = chi2(design, none, pairs_[t], options_.reach);
    gain.seen_after = then.seen;
    gain.told_after = then.told;
    if (!gain.attainable) continue;
    result.before = std::min(result.before, ratio({gain.seen_before, gain.told_before}, t));
    result.after = std::min(result.after, ratio(then, t));
  }
  return result;
}

}  // namespace

NextPoses next_poses(const Baseline& baseline, const Candidates& candidates,
                     const std::vector<PoolPose>& pool, const std::vector<Target>& targets,
                     const NextPosesOptions& options) {
  return Choice(baseline, candidates, pool, targets, options).choose();
}

}  // namespace talus
