#include "framework/diagnosis/screen.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <numeric>
#include <stdexcept>

#include "framework/calibration/parallel.h"
#include "framework/diagnosis/screen_inside.h"

namespace talus {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Below these shares of a signal what is left of it is rounding: of products taken after the
// projection, and of products downdated by it.
constexpr double rounding = 1e-8, downdated = 3e-6;

// An orthonormal basis of the columns' span, whatever their units and rank.
MatrixXd basis(MatrixXd J) {
  for (Index c = 0; c < J.cols(); ++c) {
    const double size = J.col(c).norm();
    if (size > 0) J.col(c) /= size;
  }
  if (J.cols() == 0 || J.rows() == 0) return MatrixXd(J.rows(), 0);
  MatrixXd tall = MatrixXd::Identity(J.rows(), std::min(J.rows(), J.cols()));
  if (J.rows() > J.cols()) {
    const Eigen::HouseholderQR<MatrixXd> qr(J);
    tall = qr.householderQ() * tall;
    J = MatrixXd(qr.matrixQR().topRows(J.cols()).triangularView<Eigen::Upper>());
  }
  Eigen::ColPivHouseholderQR<MatrixXd> qr(J);
  qr.setThreshold(1e-10);
  return tall * (qr.householderQ() * MatrixXd::Identity(J.rows(), qr.rank()));
}

std::vector<int> places(const Baseline& baseline, Index data, std::vector<int>& order) {
  auto when = [&](int row) {
    const int pose = baseline.pose[row];
    return baseline.when.empty() ? pose : baseline.when.at(pose);
  };
  order.resize(data);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return when(a) < when(b); });
  const int last = data > 0 ? when(order.back()) : -1;
  std::vector<int> place(last + 2, 0);
  for (Index r = 0; r < data; ++r) ++place[when(order[r]) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  return place;
}

}  // namespace

Screen::Screen(Baseline baseline, Candidates candidates, const ScreenOptions& options)
    : in_(std::make_unique<Inside>()) {
  const Index rows = baseline.rows.size(), data = candidates.columns.rows();
  if (baseline.columns.rows() != rows || static_cast<Index>(baseline.pose.size()) != rows ||
      data > rows || candidates.typical.size() != candidates.columns.cols())
    throw std::logic_error("a screen's rows and columns do not match");
  for (Index r = 0; r < rows; ++r)
    if ((baseline.pose[r] < 0) != (r >= data))
      throw std::logic_error("the priors' rows stand last, and candidates have none");
  in_->options = options;
  in_->noise_known = baseline.noise_known;
  in_->taken = baseline.taken;
  in_->place = places(baseline, data, in_->order);
  for (const int r : in_->order) in_->pose.push_back(baseline.pose[r]);
  std::vector<int> all = in_->order;
  for (Index r = data; r < rows; ++r) all.push_back(static_cast<int>(r));
  const bool sorted = std::is_sorted(all.begin(), all.end());
  if (!sorted) candidates.columns = MatrixXd(candidates.columns(in_->order, Eigen::all));
  in_->candidates = std::move(candidates);
  in_->rest = baseline.rows(all);
  in_->Q =
      basis(sorted ? std::move(baseline.columns) : MatrixXd(baseline.columns(all, Eigen::all)));
  in_->build();
}

Screen::~Screen() = default;
Screen::Screen(Screen&&) noexcept = default;
Screen& Screen::operator=(Screen&&) noexcept = default;

const Candidates& Screen::candidates() const { return in_->candidates; }
double Screen::freedom() const { return in_->freedom; }
double Screen::chi2() const { return in_->chi2; }

void Screen::accept(const Pick& pick) {
  const MatrixXd more = basis(signal(pick));
  if (in_->test(pick).strength.size() == 0) return;
  MatrixXd Q(in_->Q.rows(), in_->Q.cols() + more.cols());
  Q << in_->Q, more;
  in_->Q = std::move(Q);
  in_->build();
}

MatrixXd Screen::signal(const Pick& pick) const {
  const MatrixXd sorted = in_->project(in_->columns(pick));
  MatrixXd result = sorted;
  for (std::size_t r = 0; r < in_->order.size(); ++r)
    result.row(in_->order[r]) = sorted.row(static_cast<Index>(r));
  const auto& columns = in_->candidates.forms[pick.form].columns;
  return result * in_->candidates.typical(columns).asDiagonal();
}

MatrixXd Screen::Inside::project(const MatrixXd& data_rows) const {
  const Index data = data_rows.rows();
  MatrixXd y = -Q * (Q.topRows(data).transpose() * data_rows);
  y.topRows(data) += data_rows;
  return y;
}

MatrixXd Screen::Inside::columns(const Pick& pick) const {
  MatrixXd x = candidates.columns(Eigen::all, candidates.forms.at(pick.form).columns);
  if (pick.from > 0) x.topRows(place.at(pick.from)).setZero();
  return x;
}

const Test& Screen::Inside::test(const Pick& pick) const {
  for (int t = first.at(pick.form); t < first[pick.form + 1]; ++t)
    if (tests[t].pick == pick) return tests[t];
  throw std::logic_error("no such change point is on trial");
}

Test Screen::Inside::decompose(const Pick& pick, const MatrixXd& gram, double size,
                               double floor) const {
  Test t;
  t.pick = pick;
  t.visible = size > 0 ? std::sqrt(std::max(0.0, gram.trace())) / size : 0;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const Index n = gram.rows();
  Index seen = 0;
  while (seen < n && eigen.eigenvalues()[n - 1 - seen] > std::pow(floor * size, 2)) ++seen;
  if (seen == 0) t.visible = 0;
  t.strength = eigen.eigenvalues().tail(seen).reverse().cwiseSqrt();
  t.whiten = eigen.eigenvectors().rightCols(seen).rowwise().reverse();
  for (Index j = 0; j < seen; ++j) {
    if (t.strength[j] >= options.least_visible * std::sqrt(noise)) ++t.freedom;
    t.whiten.col(j) /= t.strength[j];
  }
  t.whiten.array().colwise() *= candidates.typical(candidates.forms[pick.form].columns).array();

  const auto scales = static_cast<Index>(options.scales.size());
  t.share.resize(seen, scales);
  t.penalty.setConstant(scales, std::log(static_cast<double>(scales)));
  for (Index c = 0; c < scales; ++c) {
    const auto ratio =
        (options.scales[c] * options.scales[c] / noise) * t.strength.array().square();
    t.share.col(c) = ratio / (1 + ratio);
    t.penalty[c] += 0.5 * ratio.log1p().sum();
  }
  return t;
}

void Screen::Inside::build() {
  rest -= Q * (Q.transpose() * rest);
  chi2 = rest.squaredNorm();
  freedom = static_cast<double>(Q.rows() - Q.cols()) - taken;
  noise = noise_known ? 1 : chi2 / std::max(1.0, freedom);

  const auto& forms = candidates.forms;
  std::vector<int> with_onset;
  tests.clear();
  first.clear();
  at_place.assign(place.size(), {});
  onset_start.assign(forms.size(), -1);
  any_whole = false;
  for (std::size_t f = 0; f < forms.size(); ++f) {
    first.push_back(static_cast<int>(tests.size()));
    auto add = [&](int from) {
      if (from >= 0) at_place[from].push_back(static_cast<int>(tests.size()));
      tests.push_back({.pick = {static_cast<int>(f), from}});
    };
    if (!forms[f].onset) {
      any_whole = true;
      add(-1);
      continue;
    }
    onset_start[f] = static_cast<int>(with_onset.size());
    with_onset.insert(with_onset.end(), forms[f].columns.begin(), forms[f].columns.end());
    for (int p = 1; p + 1 < static_cast<int>(place.size()); ++p) {
      const auto& allowed = forms[f].onsets;
      if (place[p] > 0 && place[p + 1] > place[p] &&
          (allowed.empty() || std::find(allowed.begin(), allowed.end(), p) != allowed.end()))
        add(p);
    }
  }
  first.push_back(static_cast<int>(tests.size()));
  onset_columns = candidates.columns(Eigen::all, with_onset);

  // Neighbours by about this many columns, so that their projection is one product.
  std::vector<std::vector<int>> chunks;
  std::size_t columns = 1000;
  for (std::size_t f = 0; f < forms.size(); ++f) {
    if (forms[f].onset) continue;
    if (columns >= 48) chunks.emplace_back(), columns = 0;
    chunks.back().push_back(static_cast<int>(f));
    columns += forms[f].columns.size();
  }
  parallel_chunks(static_cast<int>(chunks.size()), options.threads, [&](int chunk, int) {
    std::vector<int> used;
    for (const int f : chunks[chunk])
      used.insert(used.end(), forms[f].columns.begin(), forms[f].columns.end());
    MatrixXd x = candidates.columns(Eigen::all, used);
    x.array().rowwise() *= candidates.typical(used).transpose().array();
    const MatrixXd y = project(x);
    Index c = 0;
    for (const int f : chunks[chunk]) {
      const auto count = static_cast<Index>(forms[f].columns.size());
      const auto of = y.middleCols(c, count);
      const double size = x.middleCols(c, count).norm();
      tests[first[f]] = decompose({f, -1}, of.transpose() * of, size, rounding);
      c += count;
    }
  });
  build_onsets();
}

// All change points at once: going back in time, of every form the products X^T X and Q^T X of the
// poses from there on.
void Screen::Inside::build_onsets() {
  const Index all = onset_columns.cols();
  if (all == 0) return;
  const auto& forms = candidates.forms;
  MatrixXd absorbed = MatrixXd::Zero(Q.cols(), all);
  std::vector<MatrixXd> products(forms.size());
  for (std::size_t f = 0; f < forms.size(); ++f) {
    const auto count = static_cast<Index>(forms[f].columns.size());
    products[f] = MatrixXd::Zero(count, count);
  }
  for (int p = static_cast<int>(place.size()) - 2; p > 0; --p) {
    const int from = place[p], count = place[p + 1] - from;
    const auto rows = onset_columns.middleRows(from, count);
    absorbed.noalias() += Q.middleRows(from, count).transpose() * rows;
    for (std::size_t f = 0; f < forms.size(); ++f)
      if (onset_start[f] >= 0) {
        const auto x = rows.middleCols(onset_start[f], products[f].cols());
        products[f].noalias() += x.transpose().lazyProduct(x);
      }
    for (const int i : at_place[p]) {
      Test& t = tests[i];
      const int f = t.pick.form;
      const auto D = candidates.typical(forms[f].columns).asDiagonal();
      const auto c = absorbed.middleCols(onset_start[f], products[f].cols());
      const MatrixXd x = D * products[f] * D;
      const MatrixXd gram = x - D * (c.transpose() * c) * D;
      t = decompose(t.pick, gram, std::sqrt(x.trace()), downdated);
    }
  }
}

}  // namespace talus
