// One changed line of <calibrate>: another residual, another objective, on shipped models with the
// recordings that are shipped or simulated. Each fits to the noise, and finds what it sees.
#include <cmath>

#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string isl = shipped("isl-bonny-2013/"), device = shipped("device-nordquist-2009/");

Fit swapped(Model model, const std::string& attribute, const std::string& text,
            const Recordings& recordings) {
  set_calibrate(model, attribute, text);
  return calibrate(program_of(model), recordings, all_to_fit(recordings), {.threads = 2});
}

void check_explained(const Fit& fit) {
  CHECK(fit.converged);
  CHECK(fit.chi2 / fit.dof == doctest::Approx(1).epsilon(5 * std::sqrt(2 / fit.dof)));
}

// The truth within four standard uncertainties, for what is seen.
void check_true(const Fit& fit, const Program& truth, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const FittedValue& v = value(fit, truth.parameters[i].name);
    CAPTURE(v.name);
    if (v.identifiable) CHECK(std::abs(v.value - values[i]) < 4.5 * v.std);
  }
}

}  // namespace

TEST_CASE("the linkage's shipped recordings, with every pair of residuals of its frame") {
  const Model model = model_of(isl + "model.xml");
  const Recordings recordings = read_recordings(isl + "recordings.csv");
  const Fit base = swapped(model, "residual", "position, projection_angles", recordings);
  check_explained(base);
  for (const char* residual :
       {"position, rotation_vector", "position, inverse_direction_cosines",
        "vector_length, projection_angles", "vector_length, inverse_direction_cosines",
        "projection_angles", "inverse_direction_cosines", "vector_length"}) {
    CAPTURE(residual);
    const Fit fit = swapped(model, "residual", residual, recordings);
    check_explained(fit);
    // Less is measured, so less is seen; what is, agrees.
    CHECK(fit.seen.seen <= base.seen.seen);
    for (const FittedValue& v : fit.parameters) {
      const FittedValue& b = value(base, v.name);
      CAPTURE(v.name);
      if (v.identifiable && b.identifiable)
        CHECK(std::abs(v.value - b.value) < 5 * std::hypot(v.std, b.std));
    }
  }
}

TEST_CASE("least squares and the published objective end at nearly the same linkage") {
  for (const std::string& folder : {isl, device}) {
    CAPTURE(folder);
    const Model model = model_of(folder + "model.xml");
    const Recordings recordings = read_recordings(folder + "recordings.csv");
    const Fit one = swapped(model, "objective", "least_squares", recordings),
              other = swapped(model, "objective", "as_published", recordings);
    check_explained(one);
    check_explained(other);
    CHECK(one.chi2 < other.chi2);  // least squares has the smallest sum of squares
    CHECK(other.chi2 < 1.1 * one.chi2);
  }
}

TEST_CASE(
    "the calibration device measured whole: length and direction cosines, or all of the frame") {
  Model model = model_of(device + "spheres.xml");
  set(model, "m.sigma", "0.002 mm, 0.002 deg");
  Program true_program = program_of(model);
  const std::vector<double> truth = draw_truth(true_program, 2, 0.1);
  const Recordings recordings =
      simulate(true_program,
               grid_settings(true_program,
                             "micrometer1=9.4,13.5,17.6,21.65,25.6; micrometer2=7.6,13.9,20.75,"
                             "26.25,31.65; micrometer3=9.2,13.4,17.6,21.7,25.75"),
               {.seed = 2});
  for (const char* residual :
       {"position, rotation_vector", "position, projection_angles",
        "inverse_direction_cosines, vector_length", "inverse_direction_cosines, position"}) {
    CAPTURE(residual);
    const Fit fit = swapped(model, "residual", residual, recordings);
    check_explained(fit);
    check_true(fit, true_program, truth);
  }
}

// Three angles of a direction that has two degrees of freedom: the third tells nothing new, and
// which of them that is differs from pose to pose.
TEST_CASE("direction cosines of a measured frame count as what they are: z-scores over repeats") {
  Model model = model_of(isl + "model.xml");
  set_calibrate(model, "residual", "position, inverse_direction_cosines");
  Program true_program = program_of(model);
  const std::vector<double> truth = draw_truth(true_program, 7, 0.2);
  const Program program = program_of(model);
  double squares = 0, chi2 = 0, dof = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Recordings recordings = recorded(true_program, 100, seed);
    const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
    CHECK(fit.converged);
    CHECK(fit.dof > 100 * 5 - 38);  // five rows of six
    CHECK(fit.dof < 100 * 5 - 30);
    chi2 += fit.chi2, dof += fit.dof;
    for (std::size_t i = 0; i < truth.size(); ++i)
      if (const FittedValue& v = value(fit, true_program.parameters[i].name); v.identifiable)
        squares += std::pow((v.value - truth[i]) / v.std, 2), ++count;
  }
  CAPTURE(chi2 / dof);
  CAPTURE(squares / count);
  CHECK(chi2 / dof == doctest::Approx(1).epsilon(5 * std::sqrt(2 / dof)));
  CHECK(squares / count > 0.8);
  CHECK(squares / count < 1.25);
}

TEST_CASE("directions measured by components: the same") {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E">
      <dh name="one" theta="q1" alpha="60 ± 2"/>
      <dh name="two" theta="q2" alpha="50 ± 2"/>
    </chain>
    <encoder name="q1" intercept="0" range="-90, 90" sigma="0.001"/>
    <encoder name="q2" intercept="0 ± 2" range="-90, 90" sigma="0.001"/>
    <direction name="E" in="B" sigma="0.05"/>
    <calibrate residual="inverse_direction_cosines" of="E"/>
  </talus>)");
  const Recordings recordings = recorded(program, 400, 3);
  const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {});
  check_explained(fit);
  CHECK(fit.dof == doctest::Approx(797).epsilon(0.005));
}
