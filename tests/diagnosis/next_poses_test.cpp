#include "framework/diagnosis/next_poses.h"

#include <doctest/doctest.h>

#include "tests/diagnosis/synthetic.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

namespace {

struct Design {
  Chain fixture;  // narrow
  std::vector<PoolPose> pool;
  Chain free;
};

Design design(int poses, int pool) {
  Design d{.fixture = chain(poses, 0.25, 3), .free = chain(pool, 1.4, 4)};
  suspect_all(d.fixture);
  suspect_all(d.free);
  for (int k = 0; k < pool; ++k)
    d.pool.push_back({d.free.baseline.columns.middleRows(6 * k, 6),
                      d.free.candidates.columns.middleRows(6 * k, 6)});
  return d;
}

// The fixture's poses and those of the pool, recorded together.
Chain together(const Design& d, const std::vector<int>& chosen) {
  Chain c = d.fixture;
  const Index rows = c.baseline.rows.size(), all = rows + 6 * static_cast<Index>(chosen.size());
  c.baseline.rows = noise(all, 8);
  c.baseline.columns.conservativeResize(all, Eigen::NoChange);
  c.candidates.columns.conservativeResize(all, Eigen::NoChange);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Index at = rows + 6 * static_cast<Index>(i);
    c.baseline.columns.middleRows(at, 6) = d.pool[chosen[i]].columns;
    c.candidates.columns.middleRows(at, 6) = d.pool[chosen[i]].candidates;
    c.baseline.pose.insert(c.baseline.pose.end(), 6, c.poses++);
  }
  return c;
}

}  // namespace

TEST_CASE("what the chosen poses are said to bring is what a screen of them sees") {
  const Design d = design(40, 60);
  const VectorXd amounts = VectorXd::Constant(2, 1e-3);
  const NextPoses next = next_poses(d.fixture.baseline, d.fixture.candidates, d.pool,
                                    {{0, amounts, {1, 18}}, {37, {}, {19}}}, {.count = 5});
  REQUIRE(next.chosen.size() == 5);
  for (const bool after : {false, true}) {
    const Chain c = together(d, after ? next.chosen : std::vector<int>{});
    const Screen screen(c.baseline, c.candidates);
    const auto rivals = screen.rivals({0, -1}, amounts);
    const TargetGain& t = next.targets[0];
    const double seen = (screen.signal({0, -1}) * VectorXd::Constant(2, 1)).squaredNorm();
    CHECK((after ? t.seen_after : t.seen_before) == doctest::Approx(seen).epsilon(1e-4));
    CHECK((after ? t.told_after : t.told_before) ==
          doctest::Approx(std::min(rivals[1].left, rivals[18].left)).epsilon(1e-4));
    const auto pair = screen.rivals(std::vector<Pick>{{37, -1}});
    CHECK((after ? next.targets[1].told_after : next.targets[1].told_before) ==
          doctest::Approx(pair[0][19].left).epsilon(1e-4));
  }
}

TEST_CASE("a few chosen poses bring more than as many taken at random") {
  const Design d = design(65, 200);
  std::vector<Target> targets;
  for (const int form : {0, 18, 37, 55}) targets.push_back({form, {}, {form + 1}});
  const NextPoses next =
      next_poses(d.fixture.baseline, d.fixture.candidates, d.pool, targets, {.count = 6});
  for (const TargetGain& t : next.targets) CHECK(t.attainable);
  CHECK(next.before < 0.5);
  CHECK(next.after > 3 * next.before);
  CHECK(next.after > 1);
  double random = 0, best = 0;
  for (int run = 0; run < 10; ++run) {
    std::vector<int> some;
    for (int i = 0; i < 6; ++i) some.push_back(20 * i + run);
    std::vector<PoolPose> pool;
    for (const int i : some) pool.push_back(d.pool[i]);
    const NextPoses all =
        next_poses(d.fixture.baseline, d.fixture.candidates, pool, targets, {.count = 6});
    double worst = INFINITY;
    for (const TargetGain& t : all.targets)
      worst = std::min({worst, t.seen_after / 22, t.told_after / 12});
    random += worst / 10;
    best = std::max(best, worst);
  }
  CHECK(next.after > 1.2 * best);
  CHECK(next.after > 2 * random);
}

TEST_CASE("one pose: the best of all tried by hand") {
  const Design d = design(30, 25);
  const NextPoses next = next_poses(d.fixture.baseline, d.fixture.candidates, d.pool, {{0, {}, {}}},
                                    {.count = 1, .seen = 1});
  REQUIRE(next.chosen.size() == 1);
  double best = 0;
  int at = -1;
  for (int k = 0; k < 25; ++k) {
    const Chain c = together(d, {k});
    const double seen = Screen(c.baseline, c.candidates).signal({0, -1}).squaredNorm() / 2;
    if (seen > best) best = seen, at = k;
  }
  CHECK(next.chosen[0] == at);
  CHECK(next.targets[0].seen_after == doctest::Approx(best).epsilon(1e-4));
}

TEST_CASE("what no pose can show is said, and does not spoil the choice for others") {
  Design d = design(40, 80);
  // The twin of another suspect, and pure geometry.
  const int first = d.fixture.candidates.forms[0].columns[0];
  const auto add = [](Chain& c, const VectorXd& x) { return c.add(x, 1e-3); };
  Form geometry{300, {add(d.fixture, VectorXd(d.fixture.baseline.columns.col(5)))}};
  Form twin{301, {add(d.fixture, VectorXd(d.fixture.candidates.columns.col(first)))}};
  d.fixture.candidates.forms.push_back(geometry);
  d.fixture.candidates.forms.push_back(twin);
  for (PoolPose& p : d.pool) {
    const VectorXd g = p.columns.col(5), t = p.candidates.col(first);
    p.candidates.conservativeResize(Eigen::NoChange, p.candidates.cols() + 2);
    p.candidates.rightCols(2) << g, t;
  }
  const int last = static_cast<int>(d.fixture.candidates.forms.size()) - 1;
  const NextPoses alone =
      next_poses(d.fixture.baseline, d.fixture.candidates, d.pool, {{0, {}, {1}}}, {.count = 3});
  const NextPoses next =
      next_poses(d.fixture.baseline, d.fixture.candidates, d.pool,
                 {{last - 1, {}, {}}, {0, {}, {1}}, {last, {}, {0}}}, {.count = 3});
  CHECK_FALSE(next.targets[0].attainable);
  CHECK(next.targets[1].attainable);
  CHECK_FALSE(next.targets[2].attainable);
  CHECK(next.targets[0].seen_after < 1e-3);
  CHECK(next.chosen == alone.chosen);
  const NextPoses none = next_poses(d.fixture.baseline, d.fixture.candidates, d.pool,
                                    {{last - 1, {}, {}}}, {.count = 3});
  CHECK(none.chosen.empty());
}

TEST_CASE("the choice does not depend on the number of threads") {
  const Design d = design(30, 60);
  std::vector<Target> targets{{0, {}, {1}}, {37, {}, {}}};
  const auto one =
      next_poses(d.fixture.baseline, d.fixture.candidates, d.pool, targets, {.count = 4});
  const auto three = next_poses(d.fixture.baseline, d.fixture.candidates, d.pool, targets,
                                {.count = 4, .threads = 3});
  CHECK(one.chosen == three.chosen);
  CHECK(one.after == three.after);
}
