#include <map>

#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

double log_sum(const std::vector<double>& logs) {
  if (logs.empty()) return -INFINITY;
  const double top = *std::max_element(logs.begin(), logs.end());
  if (std::isinf(top)) return top;
  double sum = 0;
  for (const double l : logs) sum += std::exp(l - top);
  return top + std::log(sum);
}

double log_mean(const std::vector<double>& logs) {
  return log_sum(logs) - std::log(static_cast<double>(logs.size()));
}

double Screen::Inside::log_bayes(const Test& test, const VectorXd& z, double chi2_of_rows) const {
  const Index scales = test.penalty.size();
  double top = -INFINITY, sum = 0;
  for (Index c = 0; c < scales; ++c) {
    const double explained = test.share.col(c).dot(z.cwiseAbs2());
    double log = -test.penalty[c];
    if (noise_known)
      log += explained / 2;
    else if (explained > 0)
      log -= freedom / 2 * std::log1p(-std::min(1 - 1e-15, explained / chi2_of_rows));
    if (log > top) {
      sum = sum * std::exp(top - log) + 1;
      top = log;
    } else {
      sum += std::exp(log - top);
    }
  }
  return top + std::log(sum);
}

double Screen::Inside::log_p(double explained, double directions, double chi2_of_rows,
                             bool known) const {
  if (!(directions > 0)) return 0;
  if (known) return log_chi2_tail(explained, directions);
  const double others = freedom - directions;
  if (!(others > 0)) return 0;
  const double left = std::max(0.0, chi2_of_rows - explained);
  return log_f_tail(explained / directions / (left / others), directions, others);
}

// The standard deviation of the amounts, in typical ones, that makes z most likely (marginal
// likelihood, by half decades).
double Screen::Inside::likely_scale(const Test& test, const VectorXd& z, double left) const {
  double best = 1, top = -INFINITY;
  for (double c = 0.003; c < 20; c *= std::sqrt(10)) {
    double log = 0;
    for (Index j = 0; j < z.size(); ++j) {
      const double ratio = c * c * test.strength[j] * test.strength[j] / left;
      log += (z[j] * z[j] / left * ratio / (1 + ratio) - std::log1p(ratio)) / 2;
    }
    if (log > top) top = log, best = c;
  }
  return best;
}

Score Screen::Inside::score(const Test& t, const VectorXd& b) const {
  Score s;
  const VectorXd z = t.whiten.transpose() * b;
  const auto seen = z.head(t.freedom);
  s.pick = t.pick;
  s.freedom = t.freedom;
  s.visible = t.visible;
  s.log_bayes = log_bayes(t, z, chi2);
  s.all = z.squaredNorm();
  const double explained = seen.squaredNorm();
  s.log_p = log_p(explained, t.freedom, chi2, noise_known);
  const double left =
      noise_known ? 1 : std::max(0.0, chi2 - explained) / std::max(1.0, freedom - t.freedom);
  s.gain = explained / left;
  if (t.strength.size() > 3) {
    const double unexplained =
        std::max(1.0, (chi2 - explained) / std::max(1.0, freedom - t.freedom));
    s.scale = likely_scale(t, z, unexplained) / std::sqrt(unexplained);
  }
  s.estimate = t.whiten.leftCols(t.freedom) * seen;
  s.std = t.whiten.leftCols(t.freedom).rowwise().norm() * std::sqrt(left);
  return s;
}

Score Screen::score(const Pick& pick) const {
  const Test& t = in_->test(pick);
  const MatrixXd x = in_->columns(pick);
  return in_->score(t, x.transpose() * in_->rest.head(x.rows()));
}

double Screen::occam(const Pick& pick, const VectorXd& amounts) const {
  const Test& t = in_->test(pick);
  const VectorXd typical = in_->candidates.typical(in_->candidates.forms[pick.form].columns);
  // The amounts' signal along each direction that shows, in sigmas.
  const VectorXd z = t.strength.cwiseAbs2().cwiseProduct(
      t.whiten.transpose() * amounts.cwiseQuotient(typical.cwiseAbs2()));
  std::vector<double> logs;
  for (Index c = 0; c < t.penalty.size(); ++c)
    logs.push_back(-t.penalty[c] -
                   (z.cwiseAbs2().array() * (1 - t.share.col(c).array())).sum() / (2 * in_->noise));
  return log_sum(logs);
}

std::vector<Score> Screen::scores() const {
  const auto forms = in_->candidates.forms.size();
  std::vector<VectorXd> products(in_->tests.size());
  in_->each(in_->rest, [&](int t, const MatrixXd& b) { products[t] = b; });
  std::vector<Score> best(forms);
  for (std::size_t f = 0; f < forms; ++f) {
    best[f].pick = {static_cast<int>(f), -1};
    std::vector<double> logs;
    for (int t = in_->first[f]; t < in_->first[f + 1]; ++t) {
      Score s = in_->score(in_->tests[t], products[t]);
      logs.push_back(s.log_bayes);
      if (logs.size() == 1 || s.log_p < best[f].log_p) best[f] = std::move(s);
    }
    if (!logs.empty()) best[f].log_bayes = log_mean(logs);
  }
  return best;
}

std::vector<SuspectScore> Screen::suspects() const {
  struct Sum {
    std::vector<double> logs;
    double weight = 0;
    Score best;
  };
  std::map<int, Sum> sums;
  for (const Score& s : scores()) {
    const Form& form = in_->candidates.forms[s.pick.form];
    Sum& sum = sums[form.suspect];
    if (sum.logs.empty() || s.log_bayes > sum.best.log_bayes) sum.best = s;
    sum.logs.push_back(s.log_bayes + std::log(form.weight));
    sum.weight += form.weight;
  }
  std::vector<SuspectScore> result;
  for (auto& [suspect, sum] : sums)
    result.push_back({suspect, log_sum(sum.logs) - std::log(sum.weight), std::move(sum.best)});
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.log_bayes > b.log_bayes; });
  return result;
}

}  // namespace talus
