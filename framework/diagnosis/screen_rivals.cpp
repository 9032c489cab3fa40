#include <Eigen/SVD>

#include "framework/calibration/parallel.h"
#include "framework/diagnosis/screen_inside.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// What each form, at its best change point, leaves of the signals: `of` says which columns of y
// belong to each. [signal][form]
template <class Inside>
std::vector<std::vector<Rival>> imitations(const Inside& in, const MatrixXd& y,
                                           const std::vector<std::pair<Index, Index>>& of) {
  std::vector<std::vector<Rival>> result(of.size());
  std::vector<double> size;
  for (std::size_t i = 0; i < of.size(); ++i) {
    size.push_back(y.middleCols(of[i].first, of[i].second).squaredNorm());
    for (std::size_t f = 0; f < in.candidates.forms.size(); ++f)
      result[i].push_back({.pick = {static_cast<int>(f), -1}, .left = size[i] / in.noise});
  }
  MatrixXd z;
  VectorXd taken;
  in.each(y, [&](int t, const MatrixXd& b) {
    const Test& test = in.tests[t];
    if (test.strength.size() == 0) return;
    // Amounts are held to `reach` typical ones as by a prior, which only matters where they hardly
    // show.
    const double free = in.noise / (in.options.reach * in.options.reach);
    z.noalias() = test.whiten.transpose() * b;
    const auto s2 = test.strength.array().square();
    taken = (z.array().square().colwise() * (s2 / (s2 + free))).colwise().sum().transpose();
    for (std::size_t i = 0; i < of.size(); ++i) {
      const double explained = taken.segment(of[i].first, of[i].second).sum();
      Rival& best = result[i][test.pick.form];
      const double left = std::max(0.0, size[i] - explained) / in.noise;
      if (left < best.left || (best.pick.from < 0 && test.pick.from > 0 && left <= best.left))
        best = {test.pick, left, size[i] > 0 ? std::min(1.0, explained / size[i]) : 0};
    }
  });
  return result;
}

}  // namespace

std::vector<Rival> Screen::rivals(const Pick& of, const VectorXd& amounts) const {
  const MatrixXd y = in_->project(in_->columns(of) * amounts);
  return imitations(*in_, y, {{0, 1}}).front();
}

std::vector<std::vector<Rival>> Screen::rivals(const std::vector<Pick>& of) const {
  std::vector<std::vector<Rival>> result(of.size());
  constexpr int together = 16;
  const int chunks = (static_cast<int>(of.size()) + together - 1) / together;
  parallel_chunks(chunks, in_->options.threads, [&](int chunk, int) {
    const int from = chunk * together, end = std::min(from + together, static_cast<int>(of.size()));
    Index columns = 0;
    std::vector<std::pair<Index, Index>> spans;
    for (int i = from; i < end; ++i) {
      spans.emplace_back(columns, in_->candidates.forms.at(of[i].form).columns.size());
      columns += spans.back().second;
    }
    MatrixXd x(in_->candidates.columns.rows(), columns);
    for (int i = from; i < end; ++i) {
      const VectorXd typical = in_->candidates.typical(in_->candidates.forms[of[i].form].columns);
      const auto [first, count] = spans[i - from];
      x.middleCols(first, count) =
          in_->columns(of[i]) * typical.asDiagonal() / std::sqrt(static_cast<double>(count));
    }
    auto part = imitations(*in_, in_->project(x), spans);
    std::move(part.begin(), part.end(), result.begin() + from);
  });
  return result;
}

std::vector<std::vector<int>> Screen::classes(const std::vector<Pick>& picks, double cosine) const {
  const auto count = static_cast<int>(picks.size());
  std::vector<Index> start{0};
  for (const Pick& p : picks) start.push_back(start.back() + in_->test(p).freedom);
  MatrixXd U(in_->Q.rows(), start.back());
  parallel_chunks(count, in_->options.threads, [&](int i, int) {
    const Test& t = in_->test(picks[i]);
    if (t.freedom > 0)
      U.middleCols(start[i], t.freedom) =
          in_->project(in_->columns(picks[i])) * t.whiten.leftCols(t.freedom);
  });
  const MatrixXd products = U.transpose() * U;

  struct Pair {
    double cosine;
    int a, b;
  };
  std::vector<Pair> pairs;
  std::vector<std::vector<bool>> agree(count, std::vector<bool>(count, false));
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      const Index n = start[a + 1] - start[a];
      if (n == 0 || start[b + 1] - start[b] != n) continue;
      const MatrixXd between = products.block(start[a], start[b], n, n);
      if (between.squaredNorm() < cosine * cosine * static_cast<double>(n)) continue;
      const double least = Eigen::JacobiSVD<MatrixXd>(between).singularValues()[n - 1];
      if (least < cosine) continue;
      agree[a][b] = agree[b][a] = true;
      pairs.push_back({least, a, b});
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& p, const Pair& q) { return p.cosine > q.cosine; });

  std::vector<std::vector<int>> members(count);
  std::vector<int> home(count);
  for (int i = 0; i < count; ++i) {
    home[i] = i;
    if (start[i + 1] > start[i]) members[i] = {i};
  }
  for (const auto& [c, a, b] : pairs) {
    const int to = std::min(home[a], home[b]), from = std::max(home[a], home[b]);
    if (to == from) continue;
    const bool all = std::all_of(members[to].begin(), members[to].end(), [&](int i) {
      return std::all_of(members[from].begin(), members[from].end(),
                         [&](int j) { return agree[i][j]; });
    });
    if (!all) continue;
    for (const int i : members[from]) home[i] = to;
    members[to].insert(members[to].end(), members[from].begin(), members[from].end());
    std::sort(members[to].begin(), members[to].end());
    members[from].clear();
  }
  std::erase_if(members, [](const auto& m) { return m.empty(); });
  return members;
}

}  // namespace talus
