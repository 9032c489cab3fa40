// From probed points to measured features: exact without noise, with an honest covariance with it.
#include "framework/metrology/measure.h"

#include <cmath>

#include "framework/calibration/fit.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

Recordings readings_only(Recordings recordings, const Program& program) {
  for (const Feature& f : program.features)
    for (int c : f.columns)
      std::erase_if(recordings.columns,
                    [&](const RecordedColumn& r) { return r.name == program.columns[c].name; });
  return recordings;
}

const char* const models[] = {"isl-bonny-2013/published.xml", "device-nordquist-2009/published.xml",
                              "device-nordquist-2009/spheres.xml"};

}  // namespace

TEST_CASE("without noise the probed features are those that the model itself shows") {
  for (const char* file : models) {
    CAPTURE(file);
    const Program program = program_of(shipped(file));
    const Settings settings = random_settings(program, 12, 3);
    const Recordings whole = simulate(program, settings, {.seed = 1, .noise = 0});
    const Measured measured = measure(program, readings_only(whole, program),
                                      simulate_points(program, settings.poses, 1, 0));
    CHECK(measured.warnings.empty());
    for (const ShapeQuality& s : measured.shapes) CHECK(s.worst < 1e-9);
    for (const DatumQuality& d : measured.datums)
      CHECK(!(d.worst > 1e-9));  // none where it has one axis
    for (const RecordedColumn& c : whole.columns) {
      CAPTURE(c.name);
      const RecordedColumn* found = measured.recordings.find(c.name);
      REQUIRE(found);
      for (std::size_t k = 0; k < whole.rows(); ++k) {
        const double off = std::abs(found->values[k] - c.values[k]);
        CHECK(std::min(off, std::abs(found->values[k] + c.values[k])) <
              1e-7);  // a quaternion's sign
      }
    }
  }
}

TEST_CASE("the covariance of probed features is that of repeated probing") {
  for (const char* file : models) {
    CAPTURE(file);
    const Program program = program_of(shipped(file));
    Settings settings = random_settings(program, 1, 5);
    settings.poses.assign(400, settings.poses[0]);
    const Recordings whole = simulate(program, settings, {.seed = 1, .noise = 0});
    const Measured measured = measure(program, readings_only(whole, program),
                                      simulate_points(program, settings.poses, 2, 1));
    const MeasuredNoise& noise = measured.recordings.noise;
    const std::size_t n = noise.columns.size();
    for (std::size_t c = 0; c < n; ++c) {
      CAPTURE(noise.columns[c]);
      const auto& values = measured.recordings.find(noise.columns[c])->values;
      double mean = 0, square = 0, stated = 0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        mean += values[k] / 400;
        stated += std::sqrt(noise.covariance[k][c * n + c]) / 400;
      }
      for (double v : values) square += (v - mean) * (v - mean) / 399;
      CHECK(std::sqrt(square) / stated == doctest::Approx(1).epsilon(0.12));  // 3.4 sigma of 400
    }
  }
}

TEST_CASE("calibrating from probed points: chi-square is as large as it should be") {
  for (const auto& [truth, nominal] :
       {std::pair{"isl-bonny-2013/published.xml", "isl-bonny-2013/model.xml"},
        {"device-nordquist-2009/published.xml", "device-nordquist-2009/model.xml"}}) {
    CAPTURE(truth);
    const Program program = program_of(shipped(truth)), start = program_of(shipped(nominal));
    double chi2 = 0, dof = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Settings settings = random_settings(program, 60, seed);
      const Measured measured = measure(
          start, readings_only(simulate(program, settings, {.seed = seed, .noise = 1}), program),
          simulate_points(program, settings.poses, seed, 1));
      Split all;
      all.fit = all_rows(measured.recordings);
      const Fit fit = calibrate(start, measured.recordings, all, {.restarts = 0});
      chi2 += fit.chi2, dof += fit.dof;
      CHECK(fit.noise_known);
    }
    CHECK(std::abs(chi2 - dof) < 4 * std::sqrt(2 * dof));
  }
}

TEST_CASE("missing points leave their residuals out and nothing else") {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  const Settings settings = random_settings(program, 6, 3);
  const Recordings readings =
      readings_only(simulate(program, settings, {.seed = 1, .noise = 1}), program);
  Points points = simulate_points(program, settings.poses, 1, 1);
  std::erase_if(points.rows,
                [](const Points::Row& r) { return r.pose == 3 && r.feature == "E_pin"; });
  const Measured measured = measure(program, readings, points);
  for (std::size_t k = 0; k < 6; ++k)
    CHECK(std::isnan(measured.recordings.find("E.x")->values[k]) == (k == 2));
}

TEST_CASE("shapes that are not square are said") {
  Model model = model_of(shipped("device-nordquist-2009/published.xml"));
  const Program skew = program_of(model);
  const Settings settings = random_settings(skew, 4, 3);
  Points points = simulate_points(skew, settings.poses, 1, 0);
  for (Points::Row& row : points.rows)  // a shear of the machine's axes
    if (row.feature == "f_x") row.at[0] += 0.01 * (row.at[1] + row.at[2]);
  const Measured measured =
      measure(skew, readings_only(simulate(skew, settings, {.seed = 1, .noise = 0}), skew), points);
  REQUIRE(measured.warnings.size() == 1);
  CHECK(measured.warnings[0].find("from square") != std::string::npos);
  CHECK(measured.datums[0].worst > 0.2 * deg);
}

namespace {

std::string refusal(const std::string& points) {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  try {
    const Settings settings = random_settings(program, 2, 3);
    measure(program, readings_only(simulate(program, settings, {}), program),
            parse_points(points, "points.csv"));
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing to complain about";
}

}  // namespace

TEST_CASE("probing: the very words of refusals") {
  const std::string head = "pose,feature,x[mm],y[mm],z[mm]\n";
  CHECK(refusal("pose,feature,x[mm],y[mm],z[deg]\n1,a,1,2,3\n") ==
        "points.csv:1:26: the column 'z[deg]'\n  expected a length: z[mm]");
  CHECK(refusal("pose,feature,x[mm],y[mm]\n1,a,1,2\n") ==
        "points.csv:1:1: there is no column 'z'\n  expected the header "
        "pose,feature,x[mm],y[mm],z[mm]");
  CHECK(refusal(head + "1,B_face,1,2,x\n") ==
        "points.csv:2:14: 'x' is not a number\n  expected a number");
  CHECK(refusal(head + "1,B_fase,1,2,3\n") ==
        "points.csv:2: no probed shape 'B_fase' in the model\n  expected one of: B_face, B_pin, "
        "B_side, E_face, E_pin, E_side\n  did you mean 'B_face'?");
  CHECK(refusal(head + "1,B_face,1,2,3\n1,B_face,1,5,3\n") ==
        "points.csv:2: 'B_face' has 2 points\n  expected 3 or more: it is a plane");
  CHECK(refusal(head + "1,B_face,1,2,3\n1,B_face,1,5,3\n1,B_face,1,7,3\n") ==
        "points.csv:2: the points of 'B_face' do not determine a plane\n  expected points that are "
        "spread over it");
  CHECK(refusal(head + "9,B_face,1,2,3\n1,B_face,1,5,3\n1,B_face,1,7,4\n") ==
        "points.csv:2: pose 9\n  expected a pose that '' has");
  const std::string face = "1,B_face,0,0,4\n1,B_face,4,0,0\n1,B_face,0,0,-4\n";
  CHECK(refusal(head + face + "1,B_face,4,0,0\n") ==
        "points.csv:5: the same point of 'B_face' at pose 1 as in line 3\n  expected each point "
        "once");
  CHECK(refusal(head + "1,B_face,0,0,4\n1,B_face,0,0,-4\n1,B_face,4,0,0\n1,B_face,-4,0,0\n") ==
        "points.csv:2: the points of 'B_face' stand in an order that does not tell which way its "
        "axis "
        "points\n  expected points in turn around the axis, right-handed");
  CHECK(
      refusal(head + face) ==
      "points.csv: there are no points of 'B_pin'\n  expected points of all shapes: B_face, B_pin, "
      "B_side, E_face, E_pin, E_side");
  CHECK(refusal("1,B_face,0,0,4\n") ==
        "points.csv:1:1: the first row holds numbers\n  expected the header "
        "pose,feature,x[mm],y[mm],z[mm]");
}

TEST_CASE("rows that cannot be told apart by their pose are refused") {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  const Settings settings = random_settings(program, 3, 3);
  const Recordings readings =
      readings_only(simulate(program, settings, {.seed = 1, .noise = 1}), program);
  const Points points = simulate_points(program, settings.poses, 1, 1);
  for (double number : {1.0, std::nan("")}) {
    Recordings twice = readings;
    testing::column(twice, "pose").values[1] = number;
    CHECK_THROWS_AS(measure(program, twice, points), InputError);
  }
}

TEST_CASE("a blunder among the points is said, with its shape and pose") {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  const Settings settings = random_settings(program, 5, 3);
  const Recordings readings =
      readings_only(simulate(program, settings, {.seed = 1, .noise = 1}), program);
  Points points = simulate_points(program, settings.poses, 1, 1);
  for (Points::Row& row : points.rows)
    if (row.pose == 4 && row.feature == "E_face") {
      row.at[1] += 0.5;
      break;
    }
  const Measured measured = measure(program, readings, points);
  REQUIRE(measured.warnings.size() >= 1);
  CHECK(measured.warnings[0].find("'E_face'") != std::string::npos);
  CHECK(measured.warnings[0].find("pose 4") != std::string::npos);
}

namespace {

// A ball on an arm, and more shapes; calibrated, to see what the probing makes of it.
Measured probed(const std::string& shapes, double noise) {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E"><dh name="arm" theta="q" a="100"/></chain><encoder name="q"/>
    <plane name="F" at="B" sigma="0.01" probe="0,0,0; 30,0,0; 30,30,0; 0,30,0"/>
    <line name="S" at="B" sigma="0.01" probe="0,-5,5; 15,-5,5; 30,-5,5"/>
    <plane name="G" at="B" sigma="0.01" probe="5,0,0; 5,30,0; 5,30,30; 5,0,30"/>
    <datum name="D" origin="S, G" primary="z=F" secondary="x=S"/>)" +
                                       shapes + "</talus>");
  const Settings settings = random_settings(program, 20, 3);
  return measure(program,
                 readings_only(simulate(program, settings, {.seed = 1, .noise = noise}), program),
                 simulate_points(program, settings.poses, 1, noise));
}

}  // namespace

TEST_CASE("shapes that leave open what is asked of them are refused") {
  auto refused = [](const std::string& shapes) {
    try {
      probed(shapes, 1);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing to complain about");
  };
  auto says = [](const std::string& text, const std::string& words) {
    CAPTURE(text);
    CHECK(text.find(words) != std::string::npos);
  };
  const std::string ball =
      R"(<sphere name="ball" at="E" sigma="0.01" probe="5,0,0; 0,5,0; -5,0,0; 0,-5,0; 0,0,5"/>)";
  const std::string point = R"(<point name="P" in="B" at="E" probed="ball in )";
  CHECK(refused(ball + point + "D\"/>") == "nothing to complain about");
  says(refused(R"(<point name="P" in="B" at="E" probed="F in D"/>)"),
       "'F' is a plane, which has no centre");
  says(refused(ball + R"(<datum name="O" origin="ball" primary="x=F"/>)" + point + "O\"/>"),
       "the datum 'O' has one axis only");
  says(refused(ball + R"(<datum name="O" origin="ball" primary="z=F" secondary="x=F"/>)" + point +
               "O\"/>"),
       "'F' gives an axis already");
  says(
      refused(ball + R"(<plane name="H" at="B" sigma="0.01" probe="0,0,9; 30,0,9; 30,30,9; 0,30,9"/>
         <datum name="O" origin="ball" primary="z=F" secondary="x=H"/>)" +
              point + "O\"/>"),
      "deg from parallel");
  says(refused(ball + R"(<datum name="O" origin="F" primary="z=F" secondary="x=S"/>)" + point +
               "O\"/>"),
       "do not fix a point");
  says(
      refused(
          R"(<sphere name="ball" at="E" radius="5" sigma="0.01" probe="4,0,3; 0,4,3; -4,0,3; 0,-4,3"/>)" +
          point + "D\"/>"),
      "fit two different spheres equally well");
  CHECK(refused(R"(<line name="short" at="E" sigma="0.1" probe="0,0,0; 0.5,0,0; 1,0,0"/>
         <direction name="P" in="B" at="E" yaw="90" probed="short in D"/>)") !=
        "nothing to complain about");
}

TEST_CASE("the noise of a point is estimated from what the fits leave, whatever was projected") {
  for (const char* shape :
       {R"(<line name="T" at="E" on="F" probe="0,0,0; 10,0,0; 20,0,0; 30,0,0"/>)",
        R"(<circle name="T" at="E" on="F" probe="9,0,0; 0,9,0; -9,0,0; 0,-9,0; 5.4,-7.2,0"/>)",
        R"(<plane name="T" at="E" probe="9,0,0; 0,9,0; -9,0,0; 0,-9,0; 5.4,-7.2,0"/>)"}) {
    CAPTURE(shape);
    // Noise of 0.01 by a stated sigma; then measured as if none were stated.
    std::string stated = shape;
    stated.insert(stated.find(" at="), " sigma=\"0.01\"");
    auto model = [](const std::string& t) {
      return program_from(R"(<talus>
        <chain from="B" to="E"><dh name="arm" theta="q" a="100"/></chain><encoder name="q"/>
        <plane name="F" at="E" sigma="0.0001" probe="0,0,0; 90,0,0; 90,90,0; 0,90,0"/>)" +
                          t + R"(<length name="P" in="B" at="E"/></talus>)");
    };
    const Program truth = model(stated), asked = model(shape);
    const Settings settings = random_settings(truth, 400, 3);
    const Measured m = measure(asked, simulate(truth, settings, {.seed = 1, .noise = 0}),
                               simulate_points(truth, settings.poses, 1, 1));
    CHECK(m.shapes[1].sigma == doctest::Approx(0.01).epsilon(0.1));
  }
}
