#include "framework/diagnosis/sensitivity.h"

#include <doctest/doctest.h>

#include "tests/diagnosis/synthetic.h"

using namespace talus;
using namespace talus::testing;
using Eigen::VectorXd;

TEST_CASE("an effect of the smallest visible magnitude is seen in 80 of 100 recordings") {
  Chain c = chain(40, 0.8, 7);
  suspect_all(c);
  const int twin = add_twin(c, 37, 2, 300);
  c.candidates.forms.push_back({301, {c.add(c.baseline.columns.col(5), 1e-3)}});
  const double threshold = std::log(3e-4);
  const Screen screen(c.baseline, c.candidates);
  const auto all = sensitivity(screen, {.log_threshold = threshold});
  REQUIRE(all.size() == 111);
  for (const int suspect : {0, 3, 35}) {
    const Sensitivity& s = all[suspect];
    CAPTURE(suspect);
    CHECK(s.best <= s.smallest_visible);
    CHECK(s.smallest_visible <= s.worst);
    const auto& columns = c.candidates.forms[s.pick.form].columns;
    int seen = 0;
    for (int run = 0; run < 200; ++run) {
      std::mt19937_64 random(run);
      const double phase = std::uniform_real_distribution<double>(0, 2 * std::numbers::pi)(random);
      VectorXd u = VectorXd::Constant(1, 1);
      if (columns.size() == 2) u = Eigen::Vector2d(std::cos(phase), std::sin(phase));
      Chain recorded = c;
      VectorXd y = c.candidates.columns(Eigen::all, columns) *
                   c.candidates.typical(columns).cwiseProduct(u) * s.smallest_visible;
      if (s.pick.from > 0) y.head(6 * s.pick.from).setZero();
      const VectorXd w = noise(240, 500 + run) + y;
      recorded.candidates.forms = {c.candidates.forms[s.pick.form]};
      recorded.baseline.rows = w;
      seen +=
          Screen(recorded.baseline, recorded.candidates).score({0, s.pick.from}).log_p <= threshold;
    }
    CHECK(seen >= 140);
    CHECK(seen <= 178);
  }
  // A twin is the nearest rival; what is geometry is never seen.
  const Sensitivity& doubled = all[109];
  CHECK(doubled.suspect == 300);
  CHECK(doubled.pick.form == twin);
  CHECK(doubled.nearest == c.candidates.forms[37].suspect);
  CHECK(doubled.imitates > 0.97);
  CHECK(std::isinf(all[110].smallest_visible));
  CHECK(all[110].nearest == -1);
}
