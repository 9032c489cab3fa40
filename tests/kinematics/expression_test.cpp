// Expressions in attributes: what they mean, and what is said about those that mean nothing.
#include "framework/kinematics/expression.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>

using namespace talus;

namespace {

const std::map<std::string, Term> names{{"L", {300.0, length}},
                                        {"q1", {0.5, angle}},
                                        {"q2", {0.25, angle}},
                                        {"k", {2.0, number}},
                                        {"joint2.a", {40.0, length}}};

Term parse(const std::string& text) {
  return parse_expression(text, {"arm.xml", 3, 10}, [](const std::string& name, const Place& at) {
    if (auto it = names.find(name); it != names.end()) return it->second;
    throw InputError(at, "'" + name + "' is unknown");
  });
}

std::string complaint(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

void check(const std::string& text, double value, Dimension dimension) {
  CAPTURE(text);
  const Term term = parse(text);
  CHECK(term.value.constant() == doctest::Approx(value).epsilon(1e-14));
  CHECK(term.dimension == dimension);
}

}  // namespace

TEST_CASE("expressions have values and dimensions") {
  check("q1", 0.5, angle);
  check("-(q1 + q2)", -0.75, angle);
  check("q1 + 90 deg", 0.5 + 90 * deg, angle);
  check("2*L", 600, length);
  check("2 * L + 1 m", 1600, length);
  check("L/joint2.a", 7.5, number);
  check("L - joint2.a - 10 mm", 250, length);
  check("k^3*L", 2400, length);
  check("L^2/joint2.a", 2250, length);
  check("-k^2", -4, number);
  check("2 + 3*4 - 6/3/2", 13, number);
  check("(2 + 3)*4", 20, number);
  check("--k", 2, number);
  check("1e1*k", 20, number);
  check("sin(q1)*L", 300 * std::sin(0.5), length);
  check("asin(sin(q2))", 0.25, angle);
  check("atan2(L, joint2.a)", std::atan2(300.0, 40.0), angle);
  check("abs(-q1)", 0.5, angle);
  check("sign(-L)", -1, number);
  check("less(q2, q1)", 1, number);
  check("sqrt(k) + exp(0) + log(1)", std::sqrt(2.0) + 1, number);
  check("3 mm * k", 6, length);
  check("90 deg", 90 * deg, angle);
  check(" ( q1 ) ", 0.5, angle);
}

// The place is that of the character concerned: the attribute's text begins at column 10.
TEST_CASE("what is wrong with an expression, in these very words") {
  const std::pair<std::string, std::string> cases[] = {
      {"q1 + 90",
       R"(arm.xml:3:13: '+' joins an angle (deg, rad, mrad, arcmin, arcsec) and a plain number (no unit) in 'q1 + 90'
  expected two of a kind; write the unit of a number, such as 90 deg)"},
      {"L - q1",
       R"(arm.xml:3:12: '-' joins a length (mm, m, um, cm, in) and an angle (deg, rad, mrad, arcmin, arcsec) in 'L - q1'
  expected two of a kind; write the unit of a number, such as 90 deg)"},
      {"sin(k)", R"(arm.xml:3:10: sin of a plain number (no unit)
  expected an angle (deg, rad, mrad, arcmin, arcsec))"},
      {"2*asin(L)", R"(arm.xml:3:12: asin of a length (mm, m, um, cm, in)
  expected a plain number (no unit))"},
      {"atan2(q1)", R"(arm.xml:3:10: atan2 takes 2 arguments, found 1)"},
      {"sin(q1, q2)", R"(arm.xml:3:10: sin takes 1 arguments, found 2)"},
      {"atan2(L, k)", R"(arm.xml:3:10: atan2 of a plain number (no unit)
  expected a length (mm, m, um, cm, in))"},
      {"sine(q1)", R"(arm.xml:3:10: unknown function 'sine'
  expected one of: sin, cos, tan, asin, acos, sqrt, exp, log, abs, sign, atan2, less
  did you mean 'sin'?)"},
      {"2*(q1 + q2", R"(arm.xml:3:20: '(' is not closed in '2*(q1 + q2'
  expected ')')"},
      {"q1 +", R"(arm.xml:3:14: expression 'q1 +' ends early
  expected a number, a name or '(')"},
      {"q1 q2", R"(arm.xml:3:13: unexpected 'q' in expression 'q1 q2'
  expected an operator + - * / ^ or the end)"},
      {"2 * ?", R"(arm.xml:3:14: '?' in expression '2 * ?'
  expected a number, a name or '(')"},
      {"q1 + 90 dge", R"(arm.xml:3:18: 'dge' is not a unit
  expected a unit such as mm or deg)"},
      {"L^0.5", R"(arm.xml:3:15: exponent 0.5
  expected a whole number from 1 to 9)"},
      {"L^k", R"(arm.xml:3:12: 'k'
  expected a number)"},
      {"2*q9", R"(arm.xml:3:12: 'q9' is unknown)"},
  };
  for (const auto& c : cases) {
    CAPTURE(c.first);
    CHECK(complaint(c.first) == c.second);
  }
}
