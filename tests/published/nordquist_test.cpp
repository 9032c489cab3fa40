// Nordquist and Hull 2009: the calibration device as published.
#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "framework/calibration/fit.h"
#include "framework/calibration/inverse.h"
#include "framework/kinematics/angles.h"
#include "framework/kinematics/posture.h"
#include "framework/metrology/measure.h"
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string folder = "device-nordquist-2009/";

Model as_published(const std::string& objective) {
  Model model = model_of(shipped(folder + "model.xml"));
  std::function<void(Element&)> free = [&](Element& e) {  // no priors
    for (Attribute& a : e.attributes)
      if (const auto at = a.text.find(" ±"); at != std::string::npos)
        a.text = a.text.substr(0, at) + " ?";
    for (Element& child : e.children) free(child);
  };
  free(model.root);
  set_calibrate(model, "weight", "0.5, 0.5");
  set_calibrate(model, "normalise", "fsr");
  set_calibrate(model, "objective", objective);
  return model;
}

}  // namespace

TEST_CASE(
    "Nordquist 2009: 29 parameters; neutral where the drawings say so, and full-scale ranges") {
  const Program program = program_of(shipped(folder + "model.xml"));
  CHECK(program.parameters.size() == 29);
  Posture posture(program);
  const int f = program.frame("f", {}), m = program.frame("m", {});
  // Third sides 25.40, 30.48 and 25.40 mm.
  posture.set(std::vector<double>{25.40 - 7.8, 30.48 - 9.73, 25.40 - 7.8});
  const Eigen::Isometry3d T_f_m = posture.between(f, m);
  CHECK((T_f_m.translation() - Eigen::Vector3d(-101.60, -238.7346, 0)).norm() < 2e-3);
  CHECK(Eigen::AngleAxisd(T_f_m.rotation()).angle() < 2e-5);
  // The settings' ranges against Table 3: within 4 % of each.
  const Recordings recordings = read_recordings(shipped(folder + "recordings.csv"));
  CHECK(recordings.rows() == 125);
  const auto fsr = full_scale_ranges(program, recordings);
  const std::vector<double> table{24.521 * deg, 35.992 * deg, 20.17 * deg, 88.98};
  for (std::size_t i = 0; i < 4; ++i) CHECK(fsr[i] / table[i] == doctest::Approx(1).epsilon(0.05));
}

TEST_CASE("Nordquist 2009: the six-parameter transform of eq. 4") {
  const Program program = program_of(shipped(folder + "published.xml"));
  Posture posture(program);
  for (const auto& pose : random_settings(program, 20, 4).poses) {
    posture.set(pose);
    const Eigen::Matrix3d R =
        posture.between(program.frame("f", {}), program.frame("m", {})).rotation();
    const std::array<double, 3> angle = angles_of(R, parse_axis_sequence("zxy", {}));
    const double c1 = std::cos(angle[0]), s1 = std::sin(angle[0]), c3 = std::cos(angle[1]),
                 s3 = std::sin(angle[1]), c2 = std::cos(angle[2]), s2 = std::sin(angle[2]);
    Eigen::Matrix3d published;
    published << c1 * c2 - s1 * s2 * s3, -s1 * c3, c1 * s2 + s1 * c2 * s3,  //
        s1 * c2 + c1 * s2 * s3, c1 * c3, s1 * s2 - c1 * c2 * s3,            //
        -s2 * c3, s3, c2 * c3;
    CHECK((R - published).norm() < 1e-12);
  }
}

TEST_CASE("Nordquist 2009: 100 settings find the published optimum, 25 judge it") {
  const Recordings recordings = read_recordings(shipped(folder + "recordings.csv"));
  const Split split = split_rows(recordings, {.check_share = 0.2, .seed = 1});
  CHECK(split.fit.size() == 100);
  CHECK(split.check.size() == 25);
  const Program least = program_of(as_published("least_squares")),
                published = program_of(as_published("as_published"));
  const Fit a = calibrate(least, recordings, split, {.restarts = 0}),
            b = calibrate(published, recordings, split, {.max_iterations = 100000, .restarts = 0});
  CHECK(a.converged);
  CHECK(b.converged);
  CHECK(a.iterations + b.iterations < 500);  // published: 33,333
  // What lengths and direction cosines see is found again, in units of its uncertainty.
  const Program truth = program_of(shipped(folder + "published.xml"));
  CHECK(a.seen.seen == 26);
  for (const Fit* fit : {&a, &b})
    for (const Measure& m : fit->measures_check) {
      CAPTURE(m.name);
      CHECK(m.rmse < (m.dimension == length ? 0.01 : 0.006 * deg));
    }
  const Model model = model_of(shipped(folder + "published.xml"));
  int compared = 0;
  for (const FittedValue& v : a.parameters) {
    if (!v.identifiable || !std::isfinite(v.std)) continue;
    CAPTURE(v.name);
    const auto dot = v.name.find('.');
    Model copy = model;
    const Element* element = find_named(copy.root, v.name.substr(0, dot));
    const double true_value =
        parse_quantity(element->text(v.name.substr(dot + 1)), v.dimension, UnitSystem{}, {}).value;
    CHECK(std::abs(v.value - true_value) < 4.5 * v.std);
    ++compared;
  }
  CHECK(compared >= 15);
}

TEST_CASE("Nordquist 2009: eleven weights, the best by the check rows") {
  const Folder scratch;
  const Run run = command(scratch, "calibrate '" + shipped(folder + "model.xml") + "' '" +
                                       shipped(folder + "recordings.csv") +
                                       "' --check 0.2 --set normalise=fsr --sweep 0:1:0.1 "
                                       "--restarts 0 --quiet --json sweep.json");
  REQUIRE_MESSAGE(run.code == 0, run.error);
  const auto sweep = nlohmann::json::parse(contents(scratch / "sweep.json"))["sweep"];
  REQUIRE(sweep["steps"].size() == 11);
  double least = 1e300, best = -1;
  for (const auto& step : sweep["steps"]) {
    CHECK(step["measures"].size() == 4);
    if (step["mean_percent_fsr"] < least) least = step["mean_percent_fsr"], best = step["weight"];
  }
  CHECK(sweep["best"] == best);
  CHECK(least < 0.05);
  CHECK(sweep["steps"][0]["mean_percent_fsr"] > 10 * least);  // nothing says which way m points
}

TEST_CASE("Nordquist 2009: spheres on both ends show more than lengths and cosines") {
  auto seen = [](const std::string& file) {
    const Program program = program_of(shipped(folder + file));
    Program published = program_of(shipped(folder + "published.xml"));
    const Settings settings =
        settings_from(published, read_recordings(shipped(folder + "recordings.csv")), 1);
    Recordings readings = simulate(program, settings, {.seed = 3, .noise = 1});
    for (const Feature& f : program.features)
      for (int c : f.columns)
        std::erase_if(readings.columns,
                      [&](const RecordedColumn& r) { return r.name == program.columns[c].name; });
    const Measured measured =
        measure(program, readings, simulate_points(program, settings.poses, 3, 1));
    Split all;
    all.fit = all_rows(measured.recordings);
    return calibrate(program, measured.recordings, all, {.restarts = 0}).seen.seen;
  };
  CHECK(seen("model.xml") == 26);
  CHECK(seen("spheres.xml") == 27);  // a turn about m's z axis too
}
