#include "framework/kinematics/expr.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/derivative_check.h"

using namespace talus;
using namespace talus::testing;

namespace {

struct Three {
  Tape tape;
  Expr x = Expr::leaf(tape, 0), y = Expr::leaf(tape, 1), z = Expr::leaf(tape, 2);
  std::vector<std::string> names{"x", "y", "z"};

  std::string text(const Expr& e) const { return formula(e, names); }
  double value(const Expr& e, std::vector<double> slots) const {
    return e.is_constant() ? e.constant() : tape.evaluate(e.node(), slots);
  }
  double derivative(const Expr& e, int slot, std::vector<double> slots) const {
    const auto g = gradient(e);
    const auto it = g.find(slot);
    return it == g.end() ? 0 : value(it->second, slots);
  }
};

}  // namespace

TEST_CASE("constants are worked out, and what changes nothing leaves no trace") {
  Three t;
  const Expr &x = t.x, &y = t.y;
  CHECK((Expr(2) + Expr(3) * Expr(4)).constant() == 14);
  CHECK(sin(Expr(0.5)).constant() == std::sin(0.5));
  CHECK(select(Expr(0), Expr(1), Expr(2)).constant() == 2);
  const std::int32_t before = t.tape.size();
  CHECK((x + 0).same(x));
  CHECK((0 + x).same(x));
  CHECK((x - 0).same(x));
  CHECK((1 * x).same(x));
  CHECK((x * 1).same(x));
  CHECK((x / 1).same(x));
  CHECK((x * 0).same(0));
  CHECK((0 * x).same(0));
  CHECK((0 / x).same(0));
  CHECK((x - x).same(0));
  CHECK(select(Expr(1), x, y).same(x));
  CHECK(select(Expr(0), x, y).same(y));
  CHECK(select(x, y, y).same(y));
  CHECK(t.tape.size() == before);
  CHECK((-(-x)).same(x));
  CHECK((-1 * x).same(-x));
  CHECK((0 - x).same(-x));
}

TEST_CASE("equal expressions are one node") {
  Three t;
  const Expr first = sin(t.x * t.y) + t.z;
  const std::int32_t size = t.tape.size();
  CHECK((t.z + sin(t.y * t.x)).same(first));
  CHECK(t.tape.size() == size);
  CHECK(!(t.x - t.y).same(t.y - t.x));
  CHECK(!(t.x / t.y).same(t.y / t.x));
  CHECK(!atan2(t.x, t.y).same(atan2(t.y, t.x)));
  CHECK(!less(t.x, t.y).same(less(t.y, t.x)));
  CHECK(Expr::leaf(t.tape, 1).same(t.y));
  CHECK(!(t.x + 1).same(t.x + 2));
}

TEST_CASE("the value is that of the operations, in their order") {
  Three t;
  const Expr e = atan2(t.x - 2 * t.y, sqrt(t.z)) / exp(-t.x) + abs(t.y) * floor(t.z) - sign(t.x);
  const double x = -0.3, y = -1.7, z = 2.6;
  CHECK(t.value(e, {x, y, z}) ==
        doctest::Approx(std::atan2(x - 2 * y, std::sqrt(z)) / std::exp(-x) + 1.7 * 2 + 1)
            .epsilon(1e-15));
  CHECK(t.value(less(t.x, t.y), {1, 2, 0}) == 1);
  CHECK(t.value(less(t.x, t.y), {2, 2, 0}) == 0);
  CHECK(t.value(select(less(t.x, t.y), t.x, t.y), {3, 2, 0}) == 2);
}

TEST_CASE("gradients of every operation against differences") {
  Random random(1);
  const auto check = [&](auto f) {
    Leaves leaves;
    const Expr x = leaves.add(angle), y = leaves.add(angle);
    check_derivatives({f(x, y)}, leaves, random, 6);
  };
  check([](Expr x, Expr y) { return x + y * x - y; });
  check([](Expr x, Expr y) { return x / (2 + y) - y / x; });
  check([](Expr x, Expr y) { return -(x * x * y); });
  check([](Expr x, Expr y) { return sin(x) * cos(y) * tan(x * y / 2); });
  check([](Expr x, Expr y) { return asin(x * y / 2) + acos(y * x / 3); });
  check([](Expr x, Expr y) { return atan2(x, y); });  // all four quadrants
  check([](Expr x, Expr y) { return sqrt(2 + x) * exp(y) * log(3 + x); });
  check([](Expr x, Expr y) { return abs(x) * y + abs(x - y); });
  check([](Expr x, Expr y) { return select(less(x, y), x * x, sin(y)) + select(x, y, x); });
  check([](Expr x, Expr y) { return sign(x) * y + floor(5 * y) * x + less(x, y) * y; });
}

TEST_CASE("gradients at special places") {
  Three t;
  // A slot used in several places has one derivative: their sum.
  CHECK(t.derivative(t.x * t.x * t.x + t.x, 0, {2, 0, 0}) == 13);
  // What only chooses has none.
  CHECK(gradient(sign(t.x)).empty());
  CHECK(gradient(less(t.x, t.y)).empty());
  CHECK(gradient(floor(t.x)).empty());
  CHECK(gradient(Expr(3)).empty());
  // The branch not taken must not spoil the one that is: sqrt' at 0 is infinite.
  const Expr safe = select(less(0, t.x), sqrt(select(less(0, t.x), t.x, 1)), 0);
  CHECK(t.derivative(safe, 0, {0, 0, 0}) == 0);
  CHECK(t.derivative(safe, 0, {4, 0, 0}) == 0.25);
  CHECK(t.derivative(abs(t.x), 0, {-3, 0, 0}) == -1);
  CHECK(t.derivative(abs(t.x), 0, {0, 0, 0}) == 0);
  CHECK(t.derivative(atan2(t.x, t.y), 0, {0, -2, 0}) == -0.5);
  CHECK(t.derivative(atan2(t.x, t.y), 1, {3, 0, 0}) == doctest::Approx(-1.0 / 3));
}

TEST_CASE("the support is what an expression depends on") {
  Three t;
  CHECK(support(sin(t.z) + t.x) == std::vector<std::int32_t>{0, 2});
  CHECK(support(select(t.y, t.x, t.x + 1)) == std::vector<std::int32_t>{0, 1});
  CHECK(support(t.y * 0).empty());
  CHECK(support(Expr(1)).empty());
}

TEST_CASE("formulas are written with as few parentheses as are needed") {
  Three t;
  const Expr &x = t.x, &y = t.y, &z = t.z;
  CHECK(t.text(sin(x) * y + 2) == "y * sin(x) + 2");  // sums and products in order of age
  CHECK(t.text((x + y) * z) == "z * (x + y)");
  CHECK(t.text(x - (y + z)) == "x - (y + z)");
  CHECK(t.text(x - y - z) == "x - y - z");
  CHECK(t.text(x / (y * z)) == "x / (y * z)");
  CHECK(t.text(x / y / z) == "x / y / z");
  CHECK(t.text(-(x + y)) == "-(x + y)");
  CHECK(t.text(-x * y) == "y * -x");
  CHECK(t.text(x / -y) == "x / (-y)");
  CHECK(t.text(atan2(y, x)) == "atan2(y, x)");
  CHECK(t.text(select(less(x, 0), -x, x)) == "select(less(x, 0), -x, x)");
  const Expr first = x * x, second = y * y;
  CHECK(t.text(sqrt(second + first)) == "sqrt(x * x + y * y)");
  CHECK(t.text(0.5) == "0.5");
}
