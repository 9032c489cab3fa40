#include <doctest/doctest.h>

#include <Eigen/QR>

#include "framework/diagnosis/screen.h"
#include "tests/diagnosis/synthetic.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Least chi-square of the signal when the geometry and the rival are fitted to it, the rival's
// amounts with a tolerance of `reach` typical ones.
double left_after_refit(const Chain& c, const VectorXd& y, const std::vector<int>& rival, int from,
                        double reach) {
  const Index n = c.baseline.columns.cols(), m = static_cast<Index>(rival.size());
  MatrixXd A = MatrixXd::Zero(y.size() + m, n + m);
  A.topLeftCorner(y.size(), n) = c.baseline.columns;
  A.topRightCorner(y.size(), m) = c.candidates.columns(Eigen::all, rival);
  A.topRightCorner(6 * std::max(0, from), m).setZero();
  for (Index j = 0; j < m; ++j)
    A(y.size() + j, n + j) = 1 / (reach * c.candidates.typical[rival[j]]);
  VectorXd b = VectorXd::Zero(y.size() + m);
  b.head(y.size()) = y;
  return (b - A * Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).solve(b)).squaredNorm();
}

}  // namespace

TEST_CASE("what a rival leaves of a signal is what refitting it leaves") {
  Chain c = chain(30, 0.8, 3);
  suspect_all(c);
  const Screen screen(c.baseline, c.candidates);
  const Pick of{1, -1};
  const VectorXd amounts = VectorXd::Constant(2, 2e-3);
  const VectorXd y = c.candidates.columns(Eigen::all, c.candidates.forms[1].columns) * amounts;
  const double all = screen.signal(of).squaredNorm();
  CHECK(all > 0);
  const auto rivals = screen.rivals(of, amounts);
  REQUIRE(rivals.size() == c.candidates.forms.size());
  CHECK(rivals[1].left < 0.02 * (y.squaredNorm()));
  for (const int r : {0, 5, 20, 26, 28, 36, 37}) {
    CAPTURE(r);
    const Form& form = c.candidates.forms[r];
    double left = INFINITY;
    if (form.onset)
      for (int from = 1; from < 30; ++from)
        left = std::min(left, left_after_refit(c, y, form.columns, from, 10));
    else
      left = left_after_refit(c, y, form.columns, -1, 10);
    CHECK(rivals[r].left == doctest::Approx(left).epsilon(1e-5));
    CHECK(rivals[r].imitates ==
          doctest::Approx(1 - left / left_after_refit(c, y, {}, -1, 10)).epsilon(1e-5));
  }
}

TEST_CASE("lambda of two single amounts is (1 - rho^2) times the signal; accepted ones take part") {
  Chain c = chain(30, 0.8, 3);
  suspect_all(c);
  Screen screen(c.baseline, c.candidates, {.reach = 1e6});
  const auto check = [&] {
    const VectorXd e = screen.signal({19, -1}).col(0), r = screen.signal({20, -1}).col(0);
    const double rho = e.dot(r) / e.norm() / r.norm();
    const auto rivals = screen.rivals({19, -1}, VectorXd::Constant(1, 1e-3));
    CHECK(rivals[20].imitates == doctest::Approx(rho * rho));
    CHECK(rivals[20].left == doctest::Approx((1 - rho * rho) * e.squaredNorm()));
    return rho;
  };
  const double before = check();
  screen.accept({0, -1});
  CHECK(check() != doctest::Approx(before));
}

TEST_CASE("candidates of one space are one class, whatever their units; near ones are not") {
  Chain c = chain(40, 0.8, 5);
  suspect_all(c);
  const int pair = add_twin(c, 0, -7, 200), single = add_twin(c, 21, 1e3, 201);
  // Absorbed by the geometry in part: the same, once that is projected out.
  const int shifted = add_twin(c, 23, 1, 202);
  c.candidates.columns.col(c.candidates.forms[shifted].columns[0]) += c.baseline.columns.col(3);
  // All of it is geometry.
  c.candidates.forms.push_back({203, {c.add(c.baseline.columns.col(5), 1e-3)}});
  const int hidden = static_cast<int>(c.candidates.forms.size()) - 1;
  const Screen screen(c.baseline, c.candidates);
  const std::vector<Pick> picks{{0, -1},      {1, -1},       {21, -1},     {pair, -1},
                                {single, -1}, {shifted, -1}, {hidden, -1}, {23, -1}};
  const auto classes = screen.classes(picks);
  CHECK(classes == std::vector<std::vector<int>>{{0, 3}, {1}, {2, 4}, {5, 7}});
  CHECK(screen.score({hidden, -1}).freedom == 0);
  CHECK(screen.score({hidden, -1}).log_bayes == doctest::Approx(0));
}

TEST_CASE("a chain of near candidates is not one class unless all agree") {
  // Directions 3.5 degrees apart: neighbours have a cosine of 0.998, ends one of 0.993.
  Baseline b{.rows = noise(12, 1), .columns = MatrixXd(12, 0), .pose = std::vector<int>(12)};
  for (int r = 0; r < 12; ++r) b.pose[r] = r;
  Candidates c{.columns = MatrixXd::Zero(12, 3), .typical = VectorXd::Constant(3, 1)};
  for (int j = 0; j < 3; ++j) {
    c.columns(0, j) = 10 * std::cos(0.061 * j);
    c.columns(7, j) = 10 * std::sin(0.061 * j);
    c.forms.push_back({j, {j}});
  }
  const Screen screen(b, c);
  const auto classes = screen.classes({{0, -1}, {1, -1}, {2, -1}});
  REQUIRE(classes.size() == 2);
  CHECK(classes[0].size() + classes[1].size() == 3);
  CHECK(screen.classes({{0, -1}, {1, -1}, {2, -1}}, 0.99).size() == 1);
}
