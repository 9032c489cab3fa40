#include <doctest/doctest.h>

#include "framework/diagnosis/screen.h"
#include "framework/diagnosis/tails.h"
#include "tests/diagnosis/synthetic.h"

using namespace talus;
using namespace talus::testing;

namespace {

double least_p(const Screen& screen) {
  double least = 0;
  for (const Score& s : screen.scores()) least = std::min(least, s.log_p);
  return least;
}

}  // namespace

TEST_CASE("where nothing is at work the gate opens as often as it may") {
  for (const bool known : {true, false}) {
    Chain c = chain(30, 0.6, 3);
    suspect_all(c);
    c.baseline.noise_known = known;
    const double sigma = known ? 1 : 2.5;
    c.baseline.rows *= sigma;
    const Gate gate = Screen(c.baseline, c.candidates).gate({.always = true});
    CHECK(gate.draws == 400);
    int opened = 0;
    for (int run = 0; run < 400; ++run) {
      c.baseline.rows = noise(180, 1000 + run, sigma);
      opened += least_p(Screen(c.baseline, c.candidates)) <= gate.threshold;
    }
    CAPTURE(known);
    CHECK(opened >= 4);
    CHECK(opened <= 36);  // 1 % to 9 % at 5 %
  }
}

TEST_CASE("a typical effect opens the gate, the noise known or not; more noise does not") {
  Chain c = chain(65, 0.6, 3);
  suspect_all(c);
  const Eigen::VectorXd y = c.candidates.columns.col(c.candidates.forms[18].columns[0]);
  for (const bool known : {true, false}) {
    c.baseline.noise_known = known;
    int opened = 0, right = 0;
    for (int run = 0; run < 20; ++run) {
      const double sigma = known ? 1 : 1.7;
      c.baseline.rows = noise(390, 50 + run, sigma);
      const double size = Screen(c.baseline, c.candidates).signal({18, -1}).norm() / 1e-3;
      c.baseline.rows += y * (6 * sigma / size);  // expected gain of 36
      const Gate gate = Screen(c.baseline, c.candidates).gate({.draws = 200});
      opened += gate.open;
      right += gate.best.form == 18 || gate.best.form == 0;  // they imitate each other
    }
    CAPTURE(known);
    CHECK(opened >= 17);
    CHECK(right >= 15);
  }
  c.baseline.noise_known = false;
  c.baseline.rows = noise(390, 4, 3);
  CHECK_FALSE(Screen(c.baseline, c.candidates).gate().open);
}

TEST_CASE("a clear answer costs no draws, and threads do not change the others") {
  Chain c = chain(40, 0.6, 5);
  suspect_all(c);
  const Gate one = Screen(c.baseline, c.candidates).gate({.always = true});
  const Gate three =
      Screen(c.baseline, c.candidates, {.threads = 3}).gate({.threads = 3, .always = true});
  CHECK(one.threshold == three.threshold);
  CHECK(one.family_p == three.family_p);
  CHECK(one.log_p == three.log_p);
  const Gate other = Screen(c.baseline, c.candidates).gate({.seed = 2, .always = true});
  CHECK(other.threshold != one.threshold);
  CHECK(other.threshold == doctest::Approx(one.threshold).epsilon(0.1));
  // No chance of so many tests can be worse than all of them apart.
  CHECK(one.threshold >= std::log(0.05) - std::log(one.tests) - 0.7);

  c.baseline.rows += 0.05 * c.candidates.columns.col(c.candidates.forms[18].columns[0]);
  const Gate clear = Screen(c.baseline, c.candidates).gate();
  CHECK(clear.open);
  CHECK(clear.draws == 0);
  CHECK(clear.family_p < 1e-6);
}

TEST_CASE("freedom that is not in the rows is taken off where the noise is not known") {
  // Three of six rows of each pose were taken by unknowns of the pose.
  Chain c = chain(60, 0.6, 6);
  suspect_all(c);
  c.baseline.noise_known = false;
  for (int k = 0; k < 60; ++k) {
    c.baseline.rows.segment<3>(6 * k).setZero();
    c.baseline.columns.middleRows<3>(6 * k).setZero();
    c.candidates.columns.middleRows<3>(6 * k).setZero();
  }
  Chain small = c;
  std::vector<int> kept;
  for (int r = 0; r < 360; ++r)
    if (r % 6 >= 3) kept.push_back(r);
  small.baseline.rows = Eigen::VectorXd(c.baseline.rows(kept));
  small.baseline.columns = Eigen::MatrixXd(c.baseline.columns(kept, Eigen::all));
  small.candidates.columns = Eigen::MatrixXd(c.candidates.columns(kept, Eigen::all));
  small.baseline.pose.clear();
  for (int r = 0; r < 180; ++r) small.baseline.pose.push_back(r / 3);
  c.baseline.taken = 180;
  const Screen padded(c.baseline, c.candidates), plain(small.baseline, small.candidates);
  CHECK(padded.freedom() == plain.freedom());
  CHECK(padded.score({18, -1}).log_p == doctest::Approx(plain.score({18, -1}).log_p));
  CHECK(padded.score({18, -1}).log_bayes == doctest::Approx(plain.score({18, -1}).log_bayes));
  CHECK(padded.gate({.always = true}).threshold ==
        doctest::Approx(plain.gate({.always = true}).threshold).epsilon(0.1));
}
