// Where a fit may go wrong without anybody noticing: local minima, twins, outliers.
#include <cmath>

#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

// A gear of unknown ratio, read over three turns: the fit to a sine has many local minima.
TEST_CASE("scattered starts find a better minimum than the nominal values lead to") {
  const char* gear = R"(<talus>
    <chain from="B" to="E"><dh name="j" theta="q" a="100 ± 5"/></chain>
    <encoder name="q" slope="1 ± 0.5" intercept="0 ± 5" range="0, 1000"/>
    <point name="E" in="B" sigma="0.1"/>
  </talus>)";
  const Program program = program_from(gear);
  Program truth = program_from(gear);
  for (Parameter& p : truth.parameters)
    if (p.name == "q.slope") p.nominal.value = 1.6;
  const Recordings recordings = recorded(truth, 80, 1);
  const Fit local = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  CHECK(std::abs(value(local, "q.slope").value - 1.6) > 0.1);
  CHECK(local.chi2 > 1e4);
  CHECK(warns(local, "times the stated noise"));
  const Fit best = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 30});
  CHECK(value(best, "q.slope").value == doctest::Approx(1.6).epsilon(1e-3));
  CHECK(best.chi2 < 2 * best.dof);
  CHECK(warns(best, "A scattered start reached a better minimum"));
  CHECK(!warns(best, "twin"));
}

// Two bars whose distance alone is measured may be swapped.
TEST_CASE("a twin solution is warned of where there is one, and only there") {
  const char* bars = R"(<talus>
    <chain from="B" to="E">
      <dh name="upper" theta="q" a="122 ± 40"/>
      <dh name="lower" theta="q" a="118 ± 40"/>
    </chain>
    <encoder name="q" range="10, 80"/>
    <length name="P" in="B" at="E" sigma="0.01"/>
  </talus>)";
  const Program program = program_from(bars);
  Program truth = program_from(bars);
  truth.parameters[0].nominal.value = 145;
  truth.parameters[1].nominal.value = 95;
  const Recordings recordings = recorded(truth, 60, 1);
  const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 10});
  CHECK(fit.parameters[0].value + fit.parameters[1].value == doctest::Approx(240).epsilon(1e-3));
  CHECK(warns(fit, "a twin solution"));
  CHECK(warns(fit, "upper.a"));

  for (const char* file : {"isl-bonny-2013/model.xml", "arm-6r/model.xml"}) {
    const Program alone = program_of(shipped(file));
    const Recordings of = recorded(alone, 80, 2);
    CHECK(calibrate(alone, of, all_to_fit(of), {.restarts = 6}).warnings.empty());
  }
}

TEST_CASE("a robust loss resists outliers") {
  Model model = model_of(shipped("arm-6r/model.xml"));
  const Program program = program_of(model);
  Program true_program = program_of(model);
  const std::vector<double> truth = draw_truth(true_program, 9, 0.5);
  Recordings recordings = recorded(true_program, 150, 9);
  const Fit clean = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  for (int k = 5; k < 150; k += 20) column(recordings, "E.x").values[k] += 5;  // 250 sigmas
  // Errors in units of the clean fit's uncertainty, root mean square.
  auto error = [&](const Fit& fit) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      sum += std::pow((fit.x[i] - truth[i]) / clean.parameters[i].std, 2);
    return std::sqrt(sum / static_cast<double>(truth.size()));
  };
  auto with = [&](const char* loss) {
    set_calibrate(model, "loss", loss);
    const Program robust = program_of(model);
    return error(calibrate(robust, recordings, all_to_fit(recordings), {.restarts = 0}));
  };
  CHECK(error(clean) < 2);
  CHECK(with("none") > 10);
  CHECK(with("cauchy 2") < 2);
  CHECK(with("huber 2") < 5);
}

// The unknowns of each pose are left where a start ended; another start must not suffer from it.
TEST_CASE("wild starts do no harm to the unknowns of the poses") {
  Model model = model_of(shipped("ankle-storey-2006/model.xml"));
  Program true_program = program_of(with_readings_for_unknowns(model, "-40, 40"));
  draw_truth(true_program, 5, 0.3);
  const Recordings recordings = recorded(true_program, 60, 5);
  for (const char* angle : {"talocrural.roll", "talocrural.yaw", "subtalar.roll", "subtalar.yaw"}) {
    const auto dot = std::string(angle).find('.');
    Element* e = find_named(model.root, std::string(angle).substr(0, dot));
    const std::string text = e->text(std::string(angle).substr(dot + 1));
    e->set(std::string(angle).substr(dot + 1), text.substr(0, text.find(' ')) + " ± 90");
  }
  const Program program = program_of(model);
  const Fit nominal = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  REQUIRE(nominal.chi2 < 1.5 * nominal.dof);
  for (std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    CAPTURE(seed);
    const Fit fit =
        calibrate(program, recordings, all_to_fit(recordings), {.restarts = 8, .seed = seed});
    CHECK(fit.cost <= nominal.cost + 1e-6);
    CHECK(fit.chi2 < 1.5 * fit.dof);
    CHECK(fit.chi2 <= 2 * fit.cost);
  }
}
