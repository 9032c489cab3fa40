// What a problem hands to the solver, against the same made from differences of its residuals and
// of its cost.
#include "framework/calibration/problem.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "framework/calibration/solve.h"
#include "tests/support/models.h"
#include "tests/support/numeric.h"

using namespace talus;
using namespace talus::testing;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// A program with recordings of a truth near its nominal values.
struct Case {
  Program program;
  Recordings recordings;

  Case(const Model& model, int poses, std::uint64_t seed = 1, double noise = 1)
      : program(program_of(model)) {
    Program truth = program_of(with_readings_for_unknowns(model, "-30, 30"));
    draw_truth(truth, seed, 0.3);
    recordings = recorded(truth, poses, seed, noise);
  }
  Problem problem(const ProblemOptions& options = {}) const {
    return Problem(program, recordings, all_rows(recordings), Groups(program, recordings), options);
  }
};

Model isl() { return model_of(shipped("isl-bonny-2013/model.xml")); }
Model arm() { return model_of(shipped("arm-6r/model.xml")); }
Model ankle() { return model_of(shipped("ankle-storey-2006/model.xml")); }

const ProblemOptions bare{.propagate = false, .priors = false, .robust = false};

std::vector<double> steps(const Problem& problem) {
  std::vector<double> result;
  for (int i = 0; i < problem.size(); ++i)
    result.push_back(0.01 * problem.quantity(i).tolerance.value_or(1));
  return result;
}

VectorXd flat(const MatrixXd& whitened) { return whitened.reshaped(); }

// J by differences of the whitened residuals.
MatrixXd jacobian(Problem& problem, const std::vector<double>& x) {
  return differences([&](const auto& at) { return flat(problem.residuals(at).whitened); }, x,
                     steps(problem));
}

MatrixXd product(const Normal& normal) { return normal.factor.transpose() * normal.factor; }

void check_normal(Problem& problem, const std::vector<double>& x, double tolerance = 1e-7) {
  const int n = problem.size();
  const Normal normal = problem.normal(x);
  REQUIRE(normal.factor.rows() == n + 1);
  MatrixXd A(0, 0);
  const MatrixXd J = jacobian(problem, x);
  A.resize(J.rows(), n + 1);
  A << J, flat(problem.residuals(x).whitened);
  const MatrixXd expected = A.transpose() * A;
  const VectorXd size = expected.diagonal().cwiseSqrt().cwiseMax(1e-12);
  CHECK(farthest(product(normal), expected, size, size) < tolerance);
  CHECK(normal.cost == doctest::Approx(expected(n, n) / 2).epsilon(1e-12));
  CHECK(problem.cost(x) == doctest::Approx(normal.cost).epsilon(1e-12));
}

// J^T r of the normal form is the derivative of the cost.
void check_gradient(Problem& problem, const std::vector<double>& x, double tolerance = 1e-6) {
  const int n = problem.size();
  const Normal normal = problem.normal(x);
  CHECK(problem.cost(x) == doctest::Approx(normal.cost).epsilon(1e-12));
  CHECK(normal.factor.col(n).squaredNorm() == doctest::Approx(2 * normal.cost).epsilon(1e-9));
  const MatrixXd H = product(normal);
  const VectorXd g = H.col(n).head(n);
  const VectorXd expected =
      differences([&](const auto& at) { return VectorXd::Constant(1, problem.cost(at)); }, x,
                  steps(problem))
          .transpose();
  const VectorXd size = H.diagonal().head(n).cwiseSqrt() * std::sqrt(2 * normal.cost);
  for (int i = 0; i < n; ++i) {
    CAPTURE(problem.names()[i]);
    CHECK(std::abs(g[i] - expected[i]) <= tolerance * size[i]);
  }
}

Model with_loss(Model model, const std::string& attribute, const std::string& text) {
  set_calibrate(model, attribute, text);
  return model;
}

}  // namespace

TEST_CASE("the normal form is that of the rows' differences") {
  const Case c(isl(), 21);
  SUBCASE("rows divided by their sigmas") {
    Problem problem = c.problem(bare);
    check_normal(problem, problem.start());
  }
  SUBCASE("rows whitened by their whole covariance") {
    ProblemOptions options = bare;
    options.propagate = true;
    Problem problem = c.problem(options);
    CHECK(problem.whitening_depends_on_parameters());
    check_normal(problem, problem.start());
  }
  SUBCASE("weights of the papers, rows divided by their full-scale ranges") {
    const Case weighted(with_loss(isl(), "weight", "0.35, 0.65"), 21);
    Problem problem = weighted.problem(bare);
    CHECK(!problem.noise_known());
    problem.divide_rows_by({100, 200, 300, 1, 2, 3});
    check_normal(problem, problem.start());
    const auto r = problem.residuals(problem.start());
    CHECK(r.whitened(4, 1) == doctest::Approx(std::sqrt(0.35) * r.raw(4, 1) / 200));
    CHECK(r.whitened(4, 5) == doctest::Approx(std::sqrt(0.65) * r.raw(4, 5) / 3));
  }
}

TEST_CASE("sums by QR are those by Gram matrices") {
  for (const Model& model : {isl(), arm()}) {
    const Case c(model, 333);
    Problem problem = c.problem();
    const int n = problem.size();
    const Normal gram = problem.normal(problem.start());
    problem.set_qr(true);
    REQUIRE(problem.qr());
    const Normal qr = problem.normal(problem.start());
    CHECK(qr.cost == gram.cost);
    const MatrixXd H = product(gram);
    const VectorXd size = H.diagonal().cwiseSqrt();
    CHECK(farthest(product(qr), H, size, size) < 1e-11);
    CHECK(MatrixXd(qr.factor.topLeftCorner(n, n)).isUpperTriangular());
  }
}

TEST_CASE("tolerances are priors, and only where they are asked for") {
  const Case c(arm(), 9);
  Problem with = c.problem(), without = c.problem({.priors = false});
  const int n = with.size();
  std::vector<double> x = with.start();
  for (int i = 0; i < n; ++i) x[i] += 0.1 * (i % 3) * *with.quantity(i).tolerance;
  MatrixXd more = product(with.normal(x)) - product(without.normal(x));
  double cost = 0;
  for (int i = 0; i < n; ++i) {
    const double t = *with.quantity(i).tolerance, moved = x[i] - with.start()[i];
    cost += std::pow(moved / t, 2) / 2;
    CHECK(more(i, i) * t * t == doctest::Approx(1).epsilon(1e-4));
  }
  CHECK(with.cost(x) - without.cost(x) == doctest::Approx(cost).epsilon(1e-6));
  CHECK(with.information(x).cost == doctest::Approx(without.cost(x)).epsilon(1e-12));
  check_gradient(with, x);
}

TEST_CASE("the gradient of every loss and objective is the derivative of the cost") {
  const std::pair<const char*, const char*> choices[] = {
      {"loss", "none"},     {"loss", "huber 1.5"}, {"loss", "huber 40"},
      {"loss", "cauchy 2"}, {"loss", "cauchy 30"}, {"objective", "as_published"}};
  for (const auto& choice : choices) {
    const char *attribute = choice.first, *text = choice.second;
    CAPTURE(text);
    for (const Model& model : {arm(), isl(), ankle()}) {
      CAPTURE(model.root.name());
      const Case c(with_loss(model, attribute, text), 19, 2);
      Problem problem = c.problem();
      problem.set_robust(true);
      check_gradient(problem, problem.start());
    }
  }
}

// rho at small, middling and large errors, from its definition.
TEST_CASE("losses have the values they are defined by") {
  const Case plain(arm(), 1);
  const double s = 2 * plain.problem(bare).cost(plain.problem(bare).start());
  const double k = 3, m = 3;  // three rows in a pose
  auto cost = [&](const char* attribute, const char* text) {
    const Case c(with_loss(arm(), attribute, text), 1);
    ProblemOptions options = bare;
    options.robust = true;
    Problem problem = c.problem(options);
    return problem.cost(problem.start());
  };
  REQUIRE(s > k * k * m);
  CHECK(cost("loss", "huber 3") == doctest::Approx(m * (k * std::sqrt(s / m) - k * k / 2)));
  CHECK(cost("loss", "huber 1e6") == doctest::Approx(s / 2));
  CHECK(cost("loss", "cauchy 3") == doctest::Approx(m * k * k / 2 * std::log1p(s / (m * k * k))));
  CHECK(cost("objective", "as_published") == doctest::Approx(s * s / 2));
}

TEST_CASE("bounds hold, and the others make the best of it") {
  Model model = arm();
  set(model, "joint3.a", "-20.32 ± 0.75 [-20.3, -20]");
  set(model, "joint4.d", "433.07 ± 0.75 [400, 500]");
  CHECK_THROWS_AS(program_of(model), InputError);  // the value itself is out of its bounds
  set(model, "joint3.a", "-20.2 ± 0.75 [-20.3, -20.1]");
  Program program = program_of(model);
  Program truth = program_of(arm());
  const auto is_a = [](const Parameter& p) { return p.name == "joint3.a"; };
  const auto found = std::find_if(program.parameters.begin(), program.parameters.end(), is_a);
  const int a = static_cast<int>(found - program.parameters.begin());
  truth.parameters[a].nominal.value = -21;
  const Recordings recordings = recorded(truth, 60, 1);
  Problem problem(program, recordings, all_rows(recordings), Groups(program, recordings), {});
  std::vector<double> x = problem.start();
  const SolveReport report = solve(problem, x);
  CHECK(report.converged);
  CHECK(x[a] == doctest::Approx(-20.3).epsilon(1e-9));
  const Normal normal = problem.normal(x);
  const MatrixXd H = product(normal);
  for (int i = 0; i < problem.size(); ++i) {
    const double g = H(i, problem.size()) / std::sqrt(H(i, i));
    if (i == a)
      CHECK(g > 1);  // it would go further
    else
      CHECK(std::abs(g) < 1e-3);
  }
}

TEST_CASE("the result is the same bit for bit with one, two and three threads") {
  for (const Model& model : {isl(), ankle()}) {
    const Case c(with_loss(model, "loss", "cauchy 3"), 1500);
    MatrixXd factor;
    std::vector<double> solution;
    double cost = 0;
    for (int threads : {1, 2, 3}) {
      CAPTURE(threads);
      Problem problem = c.problem({.threads = threads});
      const Normal normal = problem.normal(problem.start());
      std::vector<double> x = problem.start();
      solve(problem, x, {.max_iterations = 5});
      if (threads == 1) {
        factor = normal.factor, solution = x, cost = problem.cost(x);
        continue;
      }
      CHECK(normal.factor == factor);
      CHECK(x == solution);
      CHECK(problem.cost(x) == cost);
    }
  }
}

TEST_CASE("poses add up, whichever lanes they are in") {
  const Case c(isl(), 37);
  auto part = [&](std::size_t first, std::size_t last) {
    std::vector<std::size_t> rows;
    for (std::size_t k = first; k < last; ++k) rows.push_back(k);
    Problem p(c.program, c.recordings, rows, Groups(c.program, c.recordings), bare);
    return p.cost(p.start());
  };
  CHECK(part(0, 37) ==
        doctest::Approx(part(0, 1) + part(1, 18) + part(18, 34) + part(34, 37)).epsilon(1e-13));
}

TEST_CASE("a missing value takes out the rows that need it, and no others") {
  Case c(isl(), 40);
  Problem whole = c.problem();
  const auto before = whole.residuals(whole.start());
  CHECK(whole.data().used() == 240);
  CHECK(whole.data().complete());
  column(c.recordings, "E.x").values[3] = std::nan("");      // position: three rows
  column(c.recordings, "E.qy").values[5] = std::nan("");     // orientation: three rows
  column(c.recordings, "theta4").values[30] = std::nan("");  // all six
  Problem problem = c.problem();
  CHECK(problem.data().missing() == 12);
  CHECK(problem.data().used() == 228);
  const auto after = problem.residuals(problem.start());
  for (int k = 0; k < 40; ++k)
    for (int r = 0; r < 6; ++r) {
      CAPTURE(k);
      CAPTURE(r);
      const bool missing = (k == 3 && r < 3) || (k == 5 && r >= 3) || k == 30;
      CHECK(std::isnan(after.raw(k, r)) == missing);
      if (missing)
        CHECK(after.whitened(k, r) == 0);
      else
        CHECK(after.raw(k, r) == before.raw(k, r));
    }
  Problem without_priors = c.problem({.priors = false, .robust = false});
  check_normal(without_priors, without_priors.start());

  // The covariance of what is left is a block of the whole: chi-square only falls.
  CHECK(after.whitened.row(3).norm() > 0);
  CHECK(after.whitened.row(3).norm() <= before.whitened.row(3).norm() * (1 + 1e-12));
}

// The projected cost is the least over the latent unknowns.
TEST_CASE("latent unknowns are solved for, and their gradient is that of the projected cost") {
  for (const bool priors : {false, true}) {
    CAPTURE(priors);
    Model model = ankle();
    if (priors) set(model, "q1.value", "5 ± 4"), set(model, "q2.value", "-5 ± 8");
    const Case c(model, 23, 3);
    Problem problem = c.problem();
    REQUIRE(problem.latents() == 2);
    check_gradient(problem, problem.start());

    // No other value of them has a smaller cost: they become parameters of their own.
    const auto r = problem.residuals(problem.start());
    Program spread = program_of(model);
    for (Unknown& u : spread.unknowns) u.per = {"pose"};
    Problem fixed(spread, c.recordings, all_rows(c.recordings), Groups(spread, c.recordings), {});
    std::vector<double> x = fixed.start();
    const auto p = spread.parameters.size();
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 23; ++k) x[p + 23 * i + k] = r.latent(k, i);
    CHECK(fixed.cost(x) == doctest::Approx(problem.cost(problem.start())).epsilon(1e-9));
    const MatrixXd H = product(fixed.normal(x));
    for (std::size_t i = p; i < x.size(); ++i)
      CHECK(std::abs(H(static_cast<int>(i), fixed.size())) <
            1e-5 * std::sqrt(H(static_cast<int>(i), static_cast<int>(i))));

    // Gauss-Newton after elimination is the Schur complement of the whole.
    const auto n = static_cast<Eigen::Index>(p), all = static_cast<Eigen::Index>(x.size());
    const MatrixXd B = H.block(0, n, n, all - n), C = H.block(n, n, all - n, all - n);
    const MatrixXd schur = H.topLeftCorner(n, n) - B * C.ldlt().solve(B.transpose());
    const MatrixXd reduced = product(problem.normal(problem.start())).topLeftCorner(n, n);
    const VectorXd size = reduced.diagonal().cwiseSqrt();
    CHECK(farthest(reduced, schur, size, size) < 1e-6);
  }
}

TEST_CASE("unknowns of a group are entries of x, each with the rows of its group") {
  Model model = arm();
  Element zero{.tag = "unknown"};
  zero.set("name", "slip"), zero.set("kind", "angle"), zero.set("per", "session");
  zero.set("value", "0 ± 1");
  model.root.children.push_back(zero);
  set(model, "joint2.theta", "encoder2 + slip");
  const Program program = program_of(model);
  Recordings recordings = recorded(program, 90, 1);
  std::vector<double> session;
  for (int k = 0; k < 90; ++k) {
    session.push_back(k % 3 + 1);
    column(recordings, "theta2").values[k] -= (k % 3) * 0.1 * deg;
  }
  add_column(recordings, "session", session);
  const Groups groups(program, recordings);
  Problem problem(program, recordings, all_rows(recordings), groups, {});
  const int p = static_cast<int>(program.parameters.size());
  REQUIRE(problem.size() == p + 3);
  CHECK(problem.names()[p + 1] == "slip(session=2)");
  check_gradient(problem, problem.start());
  {
    Problem plain(program, recordings, all_rows(recordings), groups, bare);
    check_normal(plain, plain.start());
  }
  std::vector<double> x = problem.start();
  CHECK(solve(problem, x).converged);
  CHECK((x[p + 1] - x[p]) / deg == doctest::Approx(0.1).epsilon(0.02));
  CHECK((x[p + 2] - x[p]) / deg == doctest::Approx(0.2).epsilon(0.02));

  // Parameters held: only the groups' entries are left.
  Problem held(program, recordings, {0, 1, 3, 4}, groups, {.only_unknowns = true});
  held.hold({x.begin(), x.begin() + p});
  REQUIRE(held.size() == 3);
  CHECK(held.occurs(0));
  CHECK(held.occurs(1));
  CHECK(!held.occurs(2));
  check_gradient(held, {x.begin() + p, x.end()});
}

TEST_CASE("with the readings' noise carried through the chain, residuals have unit variance") {
  for (const char* file :
       {"isl-bonny-2013/model.xml", "arm-6r/model.xml", "device-nordquist-2009/model.xml"}) {
    CAPTURE(file);
    Model model = model_of(shipped(file));
    if (std::string(file) == "arm-6r/model.xml")
      for (int i = 1; i <= 6; ++i) set(model, "encoder" + std::to_string(i) + ".sigma", "0.01");
    const Program program = program_of(model);
    const int poses = 4000;
    const Recordings recordings = recorded(program, poses, 5);
    Problem problem(program, recordings, all_rows(recordings), Groups(program, recordings), {});
    const MatrixXd w = problem.residuals(problem.start()).whitened;
    const MatrixXd covariance = w.transpose() * w / poses;
    const double spread = 1 / std::sqrt(poses);
    for (Eigen::Index i = 0; i < w.cols(); ++i) {
      CHECK(std::abs(w.col(i).mean()) < 5 * spread);
      for (Eigen::Index j = 0; j <= i; ++j)
        CHECK(std::abs(covariance(i, j) - (i == j)) < 5 * spread * (i == j ? std::sqrt(2) : 1));
    }
    // Without it they would be larger.
    Problem naive(program, recordings, all_rows(recordings), Groups(program, recordings),
                  {.propagate = false});
    CHECK(naive.residuals(naive.start()).whitened.squaredNorm() > 1.05 * w.squaredNorm());
  }
}
