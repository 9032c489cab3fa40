#include <map>
#include <random>

#include "framework/calibration/parallel.h"
#include "framework/diagnosis/screen_inside.h"
#include "framework/diagnosis/tails.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

constexpr int together = 16;  // draws that share a product
constexpr int batch = 96;     // draws between two looks at whether the answer is clear

// A seed of its own for each draw (splitmix64).
std::uint64_t mixed(std::uint64_t seed, std::uint64_t draw) {
  std::uint64_t x = seed + 0x9e3779b97f4a7c15ull * (draw + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// The smallest p of all tests, for each column of y.
struct Best {
  double log_p = 0;
  Pick pick;
};

template <class Inside>
std::vector<Best> best_of(const Inside& in, const MatrixXd& y, const VectorXd& chi2) {
  const Index count = y.cols();
  // For one freedom the largest gain has the smallest p.
  std::map<int, std::vector<std::pair<double, Pick>>> largest;
  MatrixXd z;
  in.each(y, [&](int t, const MatrixXd& b) {
    const Test& test = in.tests[t];
    if (test.freedom == 0) return;
    z.noalias() = test.whiten.leftCols(test.freedom).transpose().lazyProduct(b);
    auto& of_freedom = largest[test.freedom];
    if (of_freedom.empty()) of_freedom.assign(count, {0, Pick{}});
    for (Index i = 0; i < count; ++i) {
      const double gain = z.col(i).squaredNorm();
      if (gain > of_freedom[i].first) of_freedom[i] = {gain, test.pick};
    }
  });
  std::vector<Best> result(count);
  for (const auto& [freedom, of_freedom] : largest)
    for (Index i = 0; i < count; ++i) {
      const double log_p = in.log_p(of_freedom[i].first, freedom, chi2[i]);
      if (log_p < result[i].log_p) result[i] = {log_p, of_freedom[i].second};
    }
  return result;
}

}  // namespace

Gate Screen::gate(const GateOptions& options) const {
  const Inside& in = *in_;
  Gate gate;
  for (const Test& t : in.tests) gate.tests += t.freedom > 0;
  if (gate.tests == 0) return gate;
  const Best found = best_of(in, in.rest, VectorXd::Constant(1, in.chi2)).front();
  gate.best = found.pick;
  gate.log_p = found.log_p;
  const double each = std::log(static_cast<double>(gate.tests));
  gate.threshold = std::log(options.alpha) - each;
  gate.family_p = std::exp(std::min(0.0, gate.log_p + each));
  gate.open = gate.family_p <= options.alpha;
  const bool hopeless = gate.log_p > std::log(options.alpha);
  if (!options.always && (gate.open || hopeless)) return gate;

  const Index rows = in.Q.rows();
  const double share = in.freedom / (in.freedom + in.taken);
  std::vector<Best> draws(options.draws);
  int done = 0, better = 0;
  while (done < options.draws) {
    const int end = std::min(options.draws, done + batch);
    const int chunks = (end - done + together - 1) / together;
    parallel_chunks(chunks, options.threads, [&](int chunk, int) {
      const int from = done + chunk * together, count = std::min(together, end - from);
      MatrixXd y(rows, count);
      for (int i = 0; i < count; ++i) {
        std::mt19937_64 random(mixed(options.seed, from + i));
        std::normal_distribution<double> normal(0, std::sqrt(in.noise));
        for (Index r = 0; r < rows; ++r) y(r, i) = normal(random);
      }
      y -= in.Q * (in.Q.transpose() * y);
      const VectorXd chi2 = share * y.colwise().squaredNorm().transpose();
      const auto best = best_of(in, y, chi2);
      std::copy(best.begin(), best.end(), draws.begin() + from);
    });
    for (; done < end; ++done) better += draws[done].log_p <= gate.log_p;
    if (!options.always && better > 4 * options.alpha * done + 10) break;
  }
  gate.draws = done;
  std::vector<double> logs;
  for (int i = 0; i < done; ++i) logs.push_back(draws[i].log_p);
  std::sort(logs.begin(), logs.end());
  const auto allowed = static_cast<std::size_t>(options.alpha * (done + 1));
  if (allowed > 0) gate.threshold = logs[std::min(allowed, logs.size()) - 1];
  // Chance cannot do better than as many tries as there are tests, all apart from each other.
  gate.family_p = std::min(gate.family_p, (better + 1.0) / (done + 1.0));
  gate.open = gate.family_p <= options.alpha;
  return gate;
}

}  // namespace talus
