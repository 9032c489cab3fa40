#include "framework/kinematics/tape_values.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace talus;

TEST_CASE("what a node needs, and no more") {
  Tape tape;
  const Expr x = Expr::leaf(tape, 0), y = Expr::leaf(tape, 1);
  const Expr product = x * y, sum = sin(product) + x, other = cos(y);
  const std::set<std::int32_t> needed = needed_nodes(tape, {sum.node()});
  for (const Expr& e : {x, y, product, sum}) CHECK(needed.contains(e.node()));
  CHECK_FALSE(needed.contains(other.node()));
  CHECK(needed.size() == 5);
  CHECK(*needed.rbegin() == sum.node());  // arguments stand before their users
  CHECK(needed_nodes(tape, {}).empty());

  TapeValues values(tape, {sum.node(), other.node(), x.node()});
  const std::vector<double> at = values(std::vector<double>{0.5, 3});
  CHECK(at[0] == doctest::Approx(std::sin(1.5) + 0.5));
  CHECK(at[1] == doctest::Approx(std::cos(3)));
  CHECK(at[2] == 0.5);
}
