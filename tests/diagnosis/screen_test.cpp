#include "framework/diagnosis/screen.h"

#include <doctest/doctest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <numeric>

#include "framework/diagnosis/tails.h"
#include "tests/diagnosis/synthetic.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Rows left by a least-squares fit of the columns.
VectorXd left_by(const MatrixXd& J, const VectorXd& w) {
  return w - J * Eigen::CompleteOrthogonalDecomposition<MatrixXd>(J).solve(w);
}

MatrixXd beside(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

MatrixXd columns_of(const Chain& c, const Pick& pick) {
  MatrixXd x = c.candidates.columns(Eigen::all, c.candidates.forms[pick.form].columns);
  if (pick.from > 0) x.topRows(6 * pick.from).setZero();
  return x;
}

int form_of(const Chain& c, int suspect) {
  for (std::size_t f = 0; f < c.candidates.forms.size(); ++f)
    if (c.candidates.forms[f].suspect == suspect) return static_cast<int>(f);
  return -1;
}

int form_with_onset(const Chain& c, Index amounts) {
  for (std::size_t f = 0; f < c.candidates.forms.size(); ++f)
    if (c.candidates.forms[f].onset &&
        static_cast<Index>(c.candidates.forms[f].columns.size()) == amounts)
      return static_cast<int>(f);
  return -1;
}

const ScreenOptions everything{.least_visible = 1e-4};

}  // namespace

TEST_CASE("a form's gain, estimate and scatter are those of refitting with it") {
  Chain c = chain(40, 0.8, 3);
  suspect_all(c);
  const Screen screen(c.baseline, c.candidates, everything);
  for (const Pick pick : {Pick{0, -1}, Pick{1, -1}, Pick{9, -1}, Pick{form_with_onset(c, 1), 17},
                          Pick{form_with_onset(c, 6), 23}}) {
    CAPTURE(pick.form);
    const Score s = screen.score(pick);
    const MatrixXd X = columns_of(c, pick);
    const MatrixXd both = beside(c.baseline.columns, X);
    const double before = left_by(c.baseline.columns, c.baseline.rows).squaredNorm();
    const double after = left_by(both, c.baseline.rows).squaredNorm();
    REQUIRE(s.freedom == X.cols());
    CHECK(s.gain == doctest::Approx(before - after).epsilon(1e-6));
    CHECK(s.log_p == doctest::Approx(log_chi2_tail(before - after, s.freedom)).epsilon(1e-6));
    const MatrixXd projected = [&] {
      MatrixXd p = X;
      for (Index j = 0; j < X.cols(); ++j) p.col(j) = left_by(c.baseline.columns, X.col(j));
      return p;
    }();
    const VectorXd estimate = projected.householderQr().solve(c.baseline.rows);
    const VectorXd std = (projected.transpose() * projected).inverse().diagonal().cwiseSqrt();
    for (Index j = 0; j < X.cols(); ++j) {
      CHECK(s.estimate[j] == doctest::Approx(estimate[j]).epsilon(1e-5));
      CHECK(s.std[j] == doctest::Approx(std[j]).epsilon(1e-5));
    }
  }
  CHECK(screen.freedom() == 6 * 40 - 30);  // a chain of six hinges: 30 parameters
}

TEST_CASE("the Bayes factor is the ratio of the two densities of the rows") {
  Chain c = chain(12, 0.8, 5);
  suspect_all(c);
  const auto log_density = [](const MatrixXd& covariance, const VectorXd& w) {
    const Eigen::LLT<MatrixXd> factor(covariance);
    const MatrixXd L = factor.matrixL();
    return -L.diagonal().array().log().sum() - w.dot(factor.solve(w)) / 2;
  };
  // Of what the geometry cannot touch: the rows seen along an orthonormal basis of the rest.
  MatrixXd J = c.baseline.columns;
  J.colwise().normalize();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(J);
  REQUIRE(qr.rank() == 30);
  const MatrixXd rest = MatrixXd(qr.matrixQ()).rightCols(72 - 30).transpose();
  for (const double scale : {0.3, 3.0}) {
    const Screen screen(c.baseline, c.candidates, {.scales = {scale}});
    for (const int form : {0, 1, 26}) {
      const MatrixXd X = rest * columns_of(c, {form, -1}) *
                         c.candidates.typical(c.candidates.forms[form].columns).asDiagonal() *
                         scale;
      const MatrixXd none = MatrixXd::Identity(42, 42);
      const double expected = log_density(none + X * X.transpose(), rest * c.baseline.rows) -
                              log_density(none, rest * c.baseline.rows);
      CAPTURE(form);
      CHECK(screen.score({form, -1}).log_bayes == doctest::Approx(expected));
    }
  }
  // The noise unknown: its scale integrated out, the typical amounts in units of what is left.
  Chain loud = c;
  loud.baseline.noise_known = false;
  loud.baseline.rows *= 2;
  const Screen unknown(loud.baseline, loud.candidates, {.scales = {3}});
  const VectorXd left = rest * loud.baseline.rows;
  CHECK(unknown.chi2() == doctest::Approx(left.squaredNorm()));
  for (const int form : {0, 1, 26}) {
    const MatrixXd X = rest * columns_of(c, {form, -1}) *
                       c.candidates.typical(c.candidates.forms[form].columns).asDiagonal() * 3 /
                       std::sqrt(left.squaredNorm() / 42);
    const Eigen::LLT<MatrixXd> factor(MatrixXd(MatrixXd::Identity(42, 42) + X * X.transpose()));
    const double expected = -MatrixXd(factor.matrixL()).diagonal().array().log().sum() -
                            21 * std::log(left.dot(factor.solve(left)) / left.squaredNorm());
    CHECK(unknown.score({form, -1}).log_bayes == doctest::Approx(expected));
  }
  const Screen mixture(c.baseline, c.candidates);
  double sum = 0;
  for (const double scale : {0.3, 1.0, 3.0, 10.0})
    sum += std::exp(Screen(c.baseline, c.candidates, {.scales = {scale}}).score({1, -1}).log_bayes);
  CHECK(mixture.score({1, -1}).log_bayes == doctest::Approx(std::log(sum / 4)));
}

TEST_CASE("every change point is scored as a fit from there on would be") {
  Chain c = chain(30, 0.8, 7);
  suspect_all(c);
  const int slip = form_with_onset(c, 1);
  c.baseline.rows += columns_of(c, {slip, 13}) * VectorXd::Constant(1, 5e-4);
  const Screen screen(c.baseline, c.candidates, everything);
  const double before = left_by(c.baseline.columns, c.baseline.rows).squaredNorm();
  Pick best;
  double most = 0;
  std::vector<double> bayes;
  for (int from = 1; from < 30; ++from) {
    const double gain =
        before - left_by(beside(c.baseline.columns, columns_of(c, {slip, from})), c.baseline.rows)
                     .squaredNorm();
    const Score s = screen.score({slip, from});
    CHECK(s.gain == doctest::Approx(gain).epsilon(1e-6));
    bayes.push_back(s.log_bayes);
    if (gain > most) most = gain, best = {slip, from};
  }
  const Score scanned = screen.scores()[slip];
  CHECK(scanned.pick == best);
  CHECK(scanned.pick.from == 13);
  CHECK(scanned.gain == doctest::Approx(most));
  double sum = 0;
  for (const double b : bayes) sum += std::exp(b);
  CHECK(scanned.log_bayes == doctest::Approx(std::log(sum / 29)));
}

TEST_CASE("poses of one place in time stay together, whatever the order of the rows") {
  Chain c = chain(24, 0.8, 9);
  suspect_all(c);
  const int slip = form_with_onset(c, 1);
  Chain shuffled = c;
  // Poses 0, 2, 4 ... were recorded in a second session.
  for (int k = 0; k < 24; ++k) shuffled.baseline.when.push_back(k % 2 ? 0 : 1);
  const Screen screen(shuffled.baseline, shuffled.candidates);
  VectorXd x = columns_of(c, {slip, -1});
  for (int k = 1; k < 24; k += 2) x.segment<6>(6 * k).setZero();
  const double gain = left_by(c.baseline.columns, c.baseline.rows).squaredNorm() -
                      left_by(beside(c.baseline.columns, x), c.baseline.rows).squaredNorm();
  const Score s = screen.scores()[slip];
  CHECK(s.pick.from == 1);
  CHECK(s.gain == doctest::Approx(gain));
  const MatrixXd signal = screen.signal({slip, 1});
  CHECK((signal - left_by(c.baseline.columns, x) * 1e-3).norm() < 1e-9 * signal.norm());
}

TEST_CASE("tolerances count as rows; what was accepted is gone") {
  Chain c = chain(20, 0.5, 11);
  suspect_all(c);
  const Index data = c.baseline.rows.size(), n = c.baseline.columns.cols();
  Chain held = c;
  MatrixXd J(data + n, n);
  J << c.baseline.columns, VectorXd::Constant(n, 3).asDiagonal().toDenseMatrix();
  VectorXd w(data + n);
  w << c.baseline.rows, noise(n, 12);
  held.baseline.columns = J;
  held.baseline.rows = w;
  held.baseline.pose.insert(held.baseline.pose.end(), n, -1);
  Screen screen(held.baseline, held.candidates, everything);
  const auto padded = [&](const Pick& pick) {
    MatrixXd x = MatrixXd::Zero(data + n, columns_of(c, pick).cols());
    x.topRows(data) = columns_of(c, pick);
    return x;
  };
  const Pick first{1, -1}, second{form_with_onset(c, 1), 9};
  const double before = left_by(J, w).squaredNorm();
  const double with_first = left_by(beside(J, padded(first)), w).squaredNorm();
  const double with_both =
      left_by(beside(beside(J, padded(first)), padded(second)), w).squaredNorm();
  CHECK(screen.chi2() == doctest::Approx(before));
  CHECK(screen.score(first).gain == doctest::Approx(before - with_first));
  screen.accept(first);
  CHECK(screen.chi2() == doctest::Approx(with_first));
  CHECK(screen.score(first).freedom == 0);
  CHECK(screen.score(first).gain == 0);
  CHECK(screen.score(second).gain == doctest::Approx(with_first - with_both));
}

TEST_CASE("a suspect's Bayes factor is the weighted mean over its forms") {
  Chain c = chain(30, 0.8, 15);
  suspect_all(c);
  for (std::size_t f = 2; f < 18; ++f) c.candidates.forms[f].weight = f < 10 ? 2.0 : 0.5;
  const Screen screen(c.baseline, c.candidates);
  double sum = 0, weight = 0;
  Pick best;
  double most = -INFINITY;
  for (int f = 2; f < 18; ++f) {
    const double log = screen.score({f, -1}).log_bayes;
    sum += c.candidates.forms[f].weight * std::exp(log);
    weight += c.candidates.forms[f].weight;
    if (log > most) most = log, best = {f, -1};
  }
  const auto suspects = screen.suspects();
  const auto two = std::find_if(suspects.begin(), suspects.end(),
                                [](const SuspectScore& s) { return s.suspect == 2; });
  REQUIRE(two != suspects.end());
  CHECK(two->log_bayes == doctest::Approx(std::log(sum / weight)));
  CHECK(two->best.pick == best);
  CHECK(std::is_sorted(suspects.begin(), suspects.end(),
                       [](const auto& a, const auto& b) { return a.log_bayes > b.log_bayes; }));
}

TEST_CASE("a wrong pose is the one that stands out, by what leaving it out would gain") {
  Chain c = chain(25, 0.8, 17);
  suspect_all(c);
  c.baseline.rows.segment<6>(6 * 11) += noise(6, 18, 8);
  const Screen screen(c.baseline, c.candidates);
  const auto poses = screen.poses();
  REQUIRE(poses.size() == 25);
  for (const int k : {3, 11}) {
    MatrixXd freed = MatrixXd::Zero(150, 6);
    freed.middleRows<6>(6 * k).setIdentity();
    const double gain = left_by(c.baseline.columns, c.baseline.rows).squaredNorm() -
                        left_by(beside(c.baseline.columns, freed), c.baseline.rows).squaredNorm();
    CHECK(poses[k].pose == k);
    CHECK(poses[k].gain == doctest::Approx(gain).epsilon(1e-5));
    CHECK(poses[k].log_p == doctest::Approx(log_chi2_tail(gain, 6)).epsilon(1e-5));
  }
  for (const PoseScore& p : poses) CHECK((p.pose == 11 || p.log_p > poses[11].log_p + 10));
}

TEST_CASE("the true suspect comes first; a wrong typical size hardly matters") {
  Chain c = chain(65, 1.2, 13);
  suspect_all(c);
  const VectorXd typical = c.candidates.typical;
  for (const double wrong : {0.2, 1.0, 5.0}) {
    int first = 0, runs = 0;
    c.candidates.typical = wrong * typical;
    for (const int suspect : {0, 2, 9, 20, 35, 53, 108})
      for (int run = 0; run < 3; ++run) {
        const int form = form_of(c, suspect);
        const auto& columns = c.candidates.forms[form].columns;
        VectorXd y = columns_of(c, {form, c.candidates.forms[form].onset ? 30 : -1}) *
                     typical(columns).cwiseProduct(
                         noise(static_cast<Index>(columns.size()), 40 + run).cwiseSign());
        c.baseline.rows = noise(390, 100 * suspect + run);
        const Screen quiet(c.baseline, c.candidates);
        const VectorXd seen = left_by(c.baseline.columns, y);
        c.baseline.rows += y * (8 / seen.norm());  // eight sigmas
        first += Screen(c.baseline, c.candidates).suspects().front().suspect == suspect;
        ++runs;
      }
    CAPTURE(wrong);
    CHECK(first >= runs - 3);
  }
}
