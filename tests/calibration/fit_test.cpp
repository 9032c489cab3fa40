// Calibrations from start to end, of recordings whose truth is known.
#include "framework/calibration/fit.h"

#include <Eigen/LU>
#include <cmath>
#include <set>

#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

// How much more the truth costs than the fit, twice: chi-square on as many degrees of freedom as
// there are parameters, where the truth is drawn from their tolerances.
double chi_square(const Program& program, const Recordings& recordings, const Split& split,
                  const Fit& fit, const std::vector<double>& truth) {
  Problem problem(program, recordings, split.fit, Groups(program, recordings), {});
  problem.set_weights(fit.x);
  return 2 * (problem.cost(truth) - problem.cost(fit.x));
}

}  // namespace

TEST_CASE("parameters come back within their standard uncertainties") {
  struct Device {
    std::string file;
    int poses;
    double share;  // of the tolerances that the truth is away from nominal
  };
  const Device devices[] = {
      {"isl-bonny-2013/model.xml", 100, 1},      {"arm-6r/model.xml", 120, 1},
      {"arm-ur10/model.xml", 150, 0.5},          {"device-nordquist-2009/model.xml", 120, 0.5},
      {"ankle-storey-2006/model.xml", 150, 0.3}, {"mount-altaz/model.xml", 60, 1}};
  for (const Device& device : devices) {
    const auto& file = device.file;
    const int poses = device.poses;
    const double share = device.share;
    CAPTURE(file);
    const Model model = model_of(shipped(file));
    double sum = 0, dof = 0;
    for (std::uint64_t seed : {1, 2, 3, 4}) {
      CAPTURE(seed);
      const Program program = program_of(model);
      Program true_program = program_of(with_readings_for_unknowns(model, "-40, 40"));
      const std::vector<double> truth = draw_truth(true_program, 100 + seed, share);
      const Recordings recordings = recorded(true_program, poses, seed);
      const Split split = random_split(recordings, seed);
      const Fit fit = calibrate(program, recordings, split, {});
      CHECK(fit.converged);
      CHECK(fit.noise_known);
      CHECK(fit.poses_fit + fit.poses_check == static_cast<std::size_t>(poses));

      // Against the truth: nothing far off, neither one by one nor as a whole.
      for (std::size_t i = 0; i < truth.size(); ++i) {
        CAPTURE(fit.parameters[i].name);
        CHECK(fit.parameters[i].value == fit.x[i]);
        CHECK(std::abs(fit.x[i] - truth[i]) < 5 * fit.parameters[i].std);
        CHECK(fit.parameters[i].std <= *fit.parameters[i].tolerance * (1 + 1e-9));
      }
      sum += chi_square(program, recordings, split, fit, truth);
      dof += static_cast<double>(truth.size());

      // Residuals are what the instruments' noise explains, seen or not.
      CHECK(std::abs(fit.chi2 - fit.dof) < 5 * std::sqrt(2 * fit.dof));
      CHECK(fit.heldout_rms == doctest::Approx(1).epsilon(program.unknowns.empty() ? 0.15 : 0.3));
      CHECK(!warns(fit, "times the stated noise"));
    }
    // Truths drawn with less than their tolerances make it smaller: unseen directions keep theirs.
    CAPTURE(sum);
    CAPTURE(dof);
    CHECK(sum < dof + 4.5 * std::sqrt(2 * dof));
    if (share == 1) CHECK(sum > dof - 4.5 * std::sqrt(2 * dof));
  }
}

TEST_CASE("standard uncertainties are those of the inverse normal matrix, and shrink with poses") {
  const Program program = program_of(shipped("arm-6r/model.xml"));
  std::vector<double> first;
  for (int poses : {50, 800}) {
    const Recordings recordings = recorded(program, poses, 1);
    const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
    CHECK(std::isnan(fit.heldout_rms));
    Problem problem(program, recordings, all_rows(recordings), Groups(program, recordings), {});
    problem.set_weights(fit.x);
    const int n = problem.size();
    const Eigen::MatrixXd F = problem.normal(fit.x).factor.leftCols(n);
    const Eigen::MatrixXd C = (F.transpose() * F).inverse();
    for (int i = 0; i < n; ++i) {
      CHECK(fit.parameters[i].std == doctest::Approx(std::sqrt(C(i, i))).epsilon(1e-6));
      if (poses == 50)
        first.push_back(fit.parameters[i].std);
      else
        CHECK(fit.parameters[i].std < 0.5 * first[i]);  // about a quarter
    }
  }
}

TEST_CASE("the linkage's two unseen combinations are found, and four more when all 42 are free") {
  Model model = model_of(shipped("isl-bonny-2013/model.xml"));
  Program truth = program_of(model);
  draw_truth(truth, 3, 0.5);
  const Recordings recordings = recorded(truth, 65, 3);
  const Program program = program_of(model);
  const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  REQUIRE(program.parameters.size() == 38);
  CHECK(fit.seen.seen == 36);
  CHECK(fit.seen.singular.size() == 38);
  REQUIRE(fit.seen.unseen.size() == 2);
  CHECK(fit.seen.directions.cols() == 2);
  // The base's z and joint 1's d lie along one axis; so do the base's last angle and encoder 1's
  // zero.
  std::set<std::string> unseen;
  for (const FittedValue& v : fit.parameters)
    if (!v.identifiable) unseen.insert(v.name);
  for (const std::string name : {"joint1.d", "base.y", "encoder1.intercept", "base.c"}) {
    CAPTURE(name);
    CHECK((unseen.contains(name) || fit.seen.unseen[0].find(name) != std::string::npos ||
           fit.seen.unseen[1].find(name) != std::string::npos));
  }
  // Moving along one of them changes no residual noticeably, as the report says.
  Problem problem(program, recordings, all_rows(recordings), Groups(program, recordings), {});
  const Eigen::MatrixXd J = problem.information(fit.x).factor.leftCols(38);
  for (int k = 0; k < 2; ++k) CHECK((J * fit.seen.directions.col(k)).norm() < 1);
  // What is unseen keeps its tolerance.
  CHECK(value(fit, "joint2.a").identifiable);

  set(model, "joint6.d", "0 ± 2");
  set(model, "joint6.a", "0 ± 2");
  set(model, "joint6.alpha", "0 ± 2");
  set(model, "encoder6.intercept", "0 ± 2");
  const Program all = program_of(model);
  REQUIRE(all.parameters.size() == 42);
  const Fit more = calibrate(all, recordings, all_to_fit(recordings), {.restarts = 0});
  CHECK(more.converged);
  CHECK(more.seen.seen == 36);
  CHECK(more.seen.unseen.size() == 6);
  CHECK(more.chi2 == doctest::Approx(fit.chi2).epsilon(1e-3));
  CHECK(std::abs(more.dof - fit.dof) < 0.5);  // parameters that are not seen take nothing away
}

TEST_CASE("ten thousand poses with two angles each that nobody measured") {
  const Model model = model_of(shipped("ankle-storey-2006/model.xml"));
  Program true_program = program_of(with_readings_for_unknowns(model, "-40, 40"));
  const std::vector<double> truth = draw_truth(true_program, 5, 0.3);
  const Recordings recordings = recorded(true_program, 10000, 5);
  const Program program = program_of(model);
  const Split split = random_split(recordings, 1);
  const Fit fit = calibrate(program, recordings, split, {.threads = 2, .restarts = 0});
  MESSAGE("10000 poses, 20000 latent angles: ", fit.seconds, " s, ", fit.iterations, " iterations");
  CHECK(fit.converged);
  CHECK(chi_square(program, recordings, split, fit, truth) < 14 + 5 * std::sqrt(28));
  CHECK(std::abs(fit.chi2 - fit.dof) < 5 * std::sqrt(2 * fit.dof));
  // Two of six rows go into the angles, on held-out poses as well.
  CHECK(fit.heldout_rms == doctest::Approx(std::sqrt(4.0 / 6)).epsilon(0.02));
  // The zero of each latent angle is a convention.
  CHECK(fit.seen.unseen.size() == 2);
}

TEST_CASE("groups stay whole between fit and check, and unknowns of held-out groups are found") {
  Model model = model_of(shipped("arm-6r/model.xml"));
  Element slip{.tag = "unknown"};
  slip.set("name", "slip"), slip.set("kind", "angle"), slip.set("per", "session");
  slip.set("value", "0 ± 1");
  model.root.children.push_back(slip);
  set(model, "joint2.theta", "encoder2 + slip");
  const Program program = program_of(model);
  Recordings recordings = recorded(program, 200, 1);
  std::vector<double> session;
  for (int k = 0; k < 200; ++k) {
    session.push_back(k % 10 + 1);
    column(recordings, "theta2").values[k] -= 0.01 * (k % 10) * deg;
  }
  add_column(recordings, "session", session);
  SplitOptions options;
  options.group_columns = {{"session"}};
  const Split split = split_rows(recordings, options);
  std::set<double> fitted, held;
  for (std::size_t k : split.fit) fitted.insert(session[k]);
  for (std::size_t k : split.check) held.insert(session[k]);
  CHECK(fitted.size() + held.size() == 10);
  REQUIRE(!held.empty());

  const Fit fit = calibrate(program, recordings, split, {.restarts = 0});
  CHECK(fit.converged);
  REQUIRE(fit.shared.size() == 10);
  for (int s = 0; s < 10; ++s) {
    CAPTURE(s);
    CHECK(fit.shared[s].name == "slip(session=" + std::to_string(s + 1) + ")");
    const double moved = (fit.shared[s].value - fit.shared[0].value) / deg;
    CHECK(std::abs(moved - 0.01 * s) < 0.002);
  }
  CHECK(fit.heldout_rms == doctest::Approx(1).epsilon(0.1));
}

TEST_CASE("the same seed gives the same fit, with any number of threads") {
  const Program program = program_of(shipped("arm-6r/model.xml"));
  const Recordings recordings = recorded(program, 700, 3);
  const Split split = random_split(recordings, 3);
  const Fit one = calibrate(program, recordings, split, {.threads = 1, .restarts = 2, .seed = 4});
  const Fit two = calibrate(program, recordings, split, {.threads = 2, .restarts = 2, .seed = 4});
  CHECK(one.x == two.x);
  CHECK(one.chi2 == two.chi2);
  CHECK(one.heldout_rms == two.heldout_rms);
  CHECK(one.iterations == two.iterations);
}

TEST_CASE("measures are bias, precision and range of every row") {
  const Program program = program_of(shipped("arm-6r/model.xml"));
  const Recordings recordings = recorded(program, 50, 3);
  const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  REQUIRE(fit.measures_fit.size() == 3);
  const Measure& m = fit.measures_fit[1];
  CHECK(m.name == "E.y");
  CHECK(m.count == 50);
  const Eigen::VectorXd e = fit.residuals_fit.raw.col(1);
  CHECK(m.bias == doctest::Approx(e.mean()));
  CHECK(m.rmse == doctest::Approx(std::sqrt(e.squaredNorm() / 50)));
  CHECK(m.precision == doctest::Approx(std::sqrt((e.array() - e.mean()).square().sum() / 49)));
  const auto& y = recordings.find("E.y")->values;
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  CHECK(m.fsr == doctest::Approx(*high - *low));
  CHECK(m.percent_fsr == doctest::Approx(100 * m.rmse / m.fsr));
}

TEST_CASE("both ways of solving reach the same end") {
  const Program program = program_of(shipped("isl-bonny-2013/model.xml"));
  const Recordings recordings = recorded(program, 80, 3);
  const Fit gram = calibrate(program, recordings, all_to_fit(recordings),
                             {.restarts = 0, .solver = FitOptions::Solver::gram});
  const Fit qr = calibrate(program, recordings, all_to_fit(recordings),
                           {.restarts = 0, .solver = FitOptions::Solver::qr});
  CHECK(gram.solver == "gram");
  CHECK(qr.solver == "qr");
  CHECK(qr.chi2 == doctest::Approx(gram.chi2).epsilon(1e-7));
  for (std::size_t i = 0; i < gram.x.size(); ++i)
    CHECK(std::abs(gram.x[i] - qr.x[i]) < 1e-3 * gram.parameters[i].std);
}
