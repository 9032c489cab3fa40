// Formulas for a curve of which only values at poses are known, a constant and a slope of which the
// geometry takes up.
#include "framework/diagnosis/formula.h"

#include <doctest/doctest.h>

#include <Eigen/QR>
#include <cmath>
#include <functional>
#include <random>

using namespace talus;

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

double piece(double d) {
  const double two = std::max(0.0, 2 - std::abs(d)), one = std::max(0.0, 1 - std::abs(d));
  return (two * two * two - 4 * one * one * one) / 6;
}

// One row per pose, of noise `sigma`, at circumstances drawn evenly from `low` to `high`.
CurveEvidence evidence(const std::function<double(double)>& truth, double sigma, int poses = 80,
                       std::uint64_t seed = 1, double low = -1, double high = 1.2,
                       Dimension of = angle) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(low, high);
  std::normal_distribution<double> normal;
  CurveEvidence e;
  e.of = of;
  e.x.resize(poses);
  for (double& x : e.x) x = uniform(random);
  e.weight = VectorXd::Constant(poses, 1 / (sigma * sigma));
  MatrixXd J(poses, 2);
  J << VectorXd::Ones(poses), e.x;
  const MatrixXd Q =
      Eigen::HouseholderQR<MatrixXd>(J).householderQ() * MatrixXd::Identity(poses, 2);
  VectorXd w(poses);
  for (int k = 0; k < poses; ++k) w[k] = normal(random) - truth(e.x[k]) / sigma;
  w -= Q * (Q.transpose() * w).eval();
  e.absorbed = Q.transpose() / sigma;
  e.wanted = -w / sigma;
  e.chi2 = w.squaredNorm(), e.freedom = poses - 2, e.rows = poses;
  e.typical = 0.001;
  for (const int pieces : {6, 24}) {
    MatrixXd curve(poses, pieces + 3);
    for (int k = 0; k < poses; ++k)
      for (int i = 0; i < pieces + 3; ++i)
        curve(k, i) = piece(pieces * (e.x[k] - low) / (high - low) - (i - 1));
    e.curves.push_back(std::move(curve));
  }
  return e;
}

using Outcome = FormulaChoice::Outcome;

std::string best(const FormulaChoice& c) {
  std::string name;
  for (const FormulaTerm& t : c.ranked.at(0).terms)
    name += (name.empty() ? "" : "+") + t.shape->name;
  return name;
}

}  // namespace

TEST_CASE("the formula that made the curve wins, with its settings") {
  auto bump = [](double x) { return 0.002 * std::exp(-std::pow((x - 0.3) / 0.15, 2) / 2); };
  const FormulaChoice c = choose_formula(evidence(bump, 1e-4));
  CHECK(c.outcome == Outcome::wins);
  REQUIRE(best(c) == "Gaussian bump");
  CHECK(c.ranked[0].amounts[0] == doctest::Approx(0.002).epsilon(0.1));
  CHECK(c.ranked[0].terms[0].settings[0] == doctest::Approx(0.3).epsilon(0.03));
  CHECK(c.ranked[0].terms[0].settings[1] == doctest::Approx(0.15).epsilon(0.1));
  CHECK(c.odds > kFormulaOdds);
  CHECK(c.ranked[0].bic < c.curve_bic);
}

TEST_CASE("functions of the library are told from one another") {
  struct Case {
    const char* name;
    std::function<double(double)> truth;
  };
  const double a = 0.002;
  const std::vector<Case> cases{
      {"cube", [=](double x) { return a * x * x * x; }},
      {"modulus", [=](double x) { return a * std::abs(x); }},
      {"kink", [=](double x) { return a * std::abs(x - 0.37); }},
      {"step", [=](double x) { return x > 0.41 ? a : 0; }},
      {"smooth step", [=](double x) { return a * std::tanh((x - 0.1) / 0.2); }},
      {"exponential", [=](double x) { return a * std::exp(-(x + 1) / 0.4); }},
      {"harmonic", [=](double x) { return a * std::sin(5 * x + 1); }},
      {"sinusoid", [=](double x) { return a * std::sin(6.4 * x + 1); }},
      {"square+sinusoid", [=](double x) { return 2 * a * x * x + a * std::sin(12.3 * x); }}};
  for (const Case& k : cases) {
    CAPTURE(std::string(k.name));
    const FormulaChoice c = choose_formula(evidence(k.truth, 4e-5, 120, 3));
    CHECK(c.outcome == Outcome::wins);
    const std::string name = best(c);
    CAPTURE(name);
    CHECK((name == k.name ||
           (std::string(k.name) == "square+sinusoid" && name == "sinusoid+square")));
  }
}

TEST_CASE("none wins where several do as well, where none fits, and where nothing is seen") {
  auto bump = [](double x) { return 0.002 * std::exp(-std::pow((x - 0.3) / 0.3, 2) / 2); };
  CHECK(choose_formula(evidence(bump, 1.2e-3)).outcome != Outcome::wins);  // hardly above the noise
  auto chirp = [](double x) { return 0.002 * std::sin(4 * x + 5 * x * x); };
  const FormulaChoice c = choose_formula(evidence(chirp, 2e-5, 120));
  CHECK(c.outcome == Outcome::misfit);
  CHECK(c.beside_p < kFormulaBeside);
  int wins = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    wins += choose_formula(evidence([](double) { return 0.0; }, 1e-4, 60, seed)).outcome ==
            Outcome::wins;
  CHECK(wins == 0);
}

TEST_CASE("what the geometry takes up is no formula, and adding it changes nothing") {
  auto cube = [](double x) { return 0.002 * x * x * x; };
  const FormulaChoice a = choose_formula(evidence(cube, 5e-5)),
                      b = choose_formula(
                          evidence([&](double x) { return cube(x) + 0.3 - 0.7 * x; }, 5e-5));
  CHECK(best(a) == best(b));
  CHECK(a.ranked[0].chi2 == doctest::Approx(b.ranked[0].chi2));
  for (const FormulaFit& f : a.ranked)
    for (const FormulaTerm& t : f.terms) CHECK(t.shape->name != "line");
}

TEST_CASE("a time, which begins anywhere, has its own functions; noise need not be known") {
  auto warm = [](double t) { return 0.002 * std::exp(-(t - 5000) / 1500); };
  CurveEvidence e = evidence(warm, 5e-5, 120, 2, 5000, 12000, duration);
  e.noise_known = false;
  const FormulaChoice c = choose_formula(e);
  CHECK(c.outcome == Outcome::wins);
  REQUIRE(best(c) == "exponential");
  CHECK(c.ranked[0].terms[0].settings[0] == doctest::Approx(1500).epsilon(0.1));
  CHECK(c.noise == doctest::Approx(1).epsilon(0.4));
  for (const Shape& s : formula_shapes())
    if (s.name == "harmonic") CHECK_FALSE(suits(s, duration, e.x));
}

TEST_CASE("many poses in cells tell the same") {
  auto wave = [](double x) { return 0.002 * std::sin(6.4 * x + 1); };
  const CurveEvidence e = evidence(wave, 2e-4, 2000);
  const CurveEvidence cells = in_cells(e, 500);
  CHECK(cells.x.size() <= 500);
  CHECK(cells.weight.sum() == doctest::Approx(e.weight.sum()));
  const FormulaChoice a = choose_formula(e), b = choose_formula(cells);
  REQUIRE(best(a) == best(b));
  CHECK(a.ranked[0].terms[0].settings[0] ==
        doctest::Approx(b.ranked[0].terms[0].settings[0]).epsilon(0.002));
}
