// A formula for physics outside the catalogue, from recordings to the effect that is handed out.
#include "framework/diagnosis/suggestion.h"

#include <doctest/doctest.h>

#include "framework/calibration/simulate.h"
#include "framework/dsl/read.h"
#include "framework/report/report.h"
#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string isl = shipped("isl-bonny-2013/model.xml");

// Poses of the published linkage with an effect, given as Lua, that the diagnosis does not know.
Recordings with_effect(const std::string& lua, const std::string& at) {
  Registry registry = Registry::built_in();
  run_lua_plugins(lua, "concealed.lua", registry);
  Model model = model_of(shipped("isl-bonny-2013/published.xml"));
  Element e;
  e.tag = "concealed";
  e.set("at", at);
  e.set("height", "0.4");
  model.root.children.push_back(e);
  const Program truth = compile(model, registry);
  return simulate(truth, random_settings(truth, 90, 8), {7, 1, 1});
}

}  // namespace

TEST_CASE("a bump that no effect makes is given as a formula that can be used as an effect") {
  const Diagnosed d = diagnosed(isl,
                                with_effect(R"(effect "concealed" {
      acts = "reading", height = amount(angle, "0.05 deg"),
      value = function(around, p)
        return p.height * exp(-((around.reading + 0.1) / 0.15)^2 / 2)
      end })",
                                            "encoder3"),
                                {"unknown_reading", "encoder_eccentricity"});
  REQUIRE(d.diagnosis.verdict == Verdict::unknown_physics);
  REQUIRE(d.advice.formulas.size() == 1);
  REQUIRE(d.advice.formulas[0]);
  const Suggestion& s = *d.advice.formulas[0];
  CAPTURE(s.statement);
  REQUIRE(s.wins);
  CHECK(s.by[0].first == "Gaussian bump");
  CHECK(s.circumstance == "reading of encoder3");
  CHECK(s.expression == "height * exp(-((r - centre) / width)^2 / 2)");
  const std::vector<std::pair<std::string, double>> truth{
      {"height", 0.4}, {"centre", -0.1 / deg}, {"width", 0.15 / deg}};
  REQUIRE(s.values.size() == truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    CHECK(s.values[i].name == truth[i].first);
    CHECK(s.values[i].unit == "deg");
    CHECK(s.values[i].std > 0);
    CHECK(std::abs(s.values[i].value - truth[i].second) < 4 * s.values[i].std);
  }
  CHECK(s.fit.heldout_rms < 1.2);

  // The effect and the model are files like any other.
  Registry registry = Registry::built_in();
  run_lua_plugins(s.lua, s.tag + ".lua", registry);
  const Model calibrated = calibrated_model(s.model, *s.program, s.fit);
  const Model again = read_xml(write_xml(calibrated), "again.xml", registry);
  const Program program = compile(again, registry);
  FitOptions options;
  options.restarts = 0;
  const Fit fit = calibrate(program, d.recordings, d.split, options);
  CHECK(fit.chi2 == doctest::Approx(s.fit.chi2).epsilon(0.02));
}

TEST_CASE("named effects are given no formula") {
  const Diagnosed d =
      diagnosed(isl, isl_recordings("<encoder_eccentricity at='encoder1' sine='1' cosine='1'/>"),
                {"encoder_eccentricity", "encoder_second_harmonic"});
  REQUIRE(d.advice.formulas.size() == 1);
  CHECK_FALSE(d.advice.formulas[0]);
}
