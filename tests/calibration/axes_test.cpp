#include "framework/calibration/axes.h"

#include "framework/calibration/axes_changes.h"
#include "framework/calibration/linkage_poses.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string knee = shipped("knee-two-axis/model.xml");
const std::string isl = shipped("isl-bonny-2013/");

LocateOptions once(bool observed = false) {
  LocateOptions options;
  options.fit.restarts = 0;
  options.observed = observed;
  return options;
}

Recordings moved(const Program& program, const std::string& grid, double noise,
                 std::uint64_t seed = 1) {
  return simulate(program, grid_settings(program, grid), {.seed = seed, .noise = noise});
}

// The four numbers of each axis of a program, as it stands.
std::vector<double> numbers(AxisFinder& finder, const Program& program,
                            const std::vector<View>& views) {
  std::vector<double> x, out;
  for (const Parameter& p : program.parameters) x.push_back(p.nominal.value);
  const std::vector<Line> lines = finder.lines(x);
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (double v : coordinates_of(lines[k], views[k])) out.push_back(v);
  return out;
}

void check_square(double sum, int count, double low, double high) {
  CAPTURE(sum / count);
  CHECK(sum / count > low);
  CHECK(sum / count < high);
}

}  // namespace

TEST_CASE("a line's four numbers: where it pierces the plane, how it leans") {
  const View view{Eigen::Isometry3d::Identity(), 1, "B"};
  const Line line{{3, 10, -5}, Eigen::Vector3d(-0.1, -1, 0.2).normalized()};
  const auto v = coordinates_of(line, view);
  CHECK(v[0] == doctest::Approx(3 - 1));  // x, towards x by 0.1 per y
  CHECK(v[1] == doctest::Approx(-5 + 2));
  CHECK(v[2] == doctest::Approx(std::atan(0.1)));
  CHECK(v[3] == doctest::Approx(std::atan(-0.2)));
  CHECK(AxisLabels().of(1) == std::array<std::string, 4>{"x", "z", "about z", "about x"});
  CHECK(AxisLabels().of(2) == std::array<std::string, 4>{"x", "y", "about y", "about x"});
}

TEST_CASE("axes are recovered from poses without noise, wherever they are") {
  for (const char* model : {"knee-two-axis/model.xml", "ankle-storey-2006/model.xml"})
    for (const std::uint64_t seed : {1, 2, 3}) {
      CAPTURE(model);
      CAPTURE(seed);
      Program truth = program_of(shipped(model));
      draw_truth(truth, seed, 0.7);
      Program program = program_of(shipped(model));  // tolerances that do not pull
      for (Parameter& p : program.parameters) *p.nominal.tolerance *= 1e4;
      const Recordings recordings = moved(truth, "q1=-30:60:10; q2=-20:20:10", 0);
      AxisFinder finder(program);
      REQUIRE(finder.hinges().size() == 2);
      Located located = finder.locate(recordings, all_rows(recordings), once());
      const std::vector<View> views = finder.body_views(located);
      finder.describe(located, views);
      AxisFinder true_finder(truth);
      const std::vector<double> expected = numbers(true_finder, truth, views);
      for (std::size_t k = 0; k < 2; ++k) {
        CHECK(located.axes[k].determined);
        for (std::size_t v = 0; v < 4; ++v)
          CHECK(std::abs(located.axes[k].value[v] - expected[4 * k + v]) < (v < 2 ? 1e-5 : 1e-7));
      }
    }
}

TEST_CASE("standard uncertainties are honest: z-scores over repeats, from either source") {
  const Program program = program_of(knee);
  AxisFinder finder(program);
  const std::string grid = "q1=0:100:10; q2=-15:15:5";
  double stated = 0, observed = 0, apart = 0;
  int count = 0, pairs = 0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Recordings recordings = moved(program, grid, 1, 100 + repeat);
    Located located = finder.locate(recordings, all_rows(recordings), once());
    const std::vector<View> views = finder.body_views(located);
    const std::vector<double> truth = numbers(finder, program, views);
    for (bool of_residuals : {false, true}) {
      located.observed = of_residuals;
      finder.describe(located, views);
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t v = 0; v < 4; ++v) {
          const double z = (located.axes[k].value[v] - truth[4 * k + v]) / located.axes[k].std[v];
          (of_residuals ? observed : stated) += z * z;
        }
    }
    count += 8;
    std::vector<double> x;
    for (const Parameter& p : program.parameters) x.push_back(p.nominal.value);
    finder.lines(x);
    Located at_truth = located;
    at_truth.fit.x = x;
    finder.describe(at_truth, views);
    const Apartness &a = located.apart[0], &b = at_truth.apart[0];
    apart += std::pow((a.angle - b.angle) / a.angle_std, 2) +
             std::pow((a.distance - b.distance) / a.distance_std, 2);
    pairs += 2;
  }
  check_square(stated, count, 0.75, 1.3);
  check_square(observed, count, 0.75, 1.35);
  check_square(apart, pairs, 0.65, 1.45);
}

TEST_CASE("uncertainties are honest where a linkage with noisy encoders measured the poses") {
  const Program program = program_of(isl + "axes.xml");
  Program fixture = program_of(isl + "validation.xml"), linkage = program_of(isl + "published.xml");
  const Recordings poses =
      moved(fixture, "rotation=-15:15:5; flexion=20:80:5; dPD=2.87; dAP=2.87", 0);
  const Settings settings = settings_from(linkage, poses, 1);
  AxisFinder finder(program);
  LinkagePoses measured(linkage, finder.feature());
  double sum = 0;
  int count = 0;
  for (int repeat = 0; repeat < 40; ++repeat) {
    const Recordings read = simulate(linkage, settings, {.seed = 7u + repeat});
    const Recordings recordings = measured.measured(read, program);
    Located located = finder.locate(recordings, all_rows(recordings), once(true));
    const std::vector<View> views = finder.body_views(located);
    finder.describe(located, views);
    const std::vector<double> truth = numbers(finder, program, views);
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t v = 0; v < 4; ++v) {
        const double z = (located.axes[k].value[v] - truth[4 * k + v]) / located.axes[k].std[v];
        sum += z * z;
      }
    count += 8;
  }
  check_square(sum, count, 0.7, 1.4);
}

TEST_CASE("one axis alone, and an axis whose angle is read") {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E">
      <revolute name="hinge" theta="encoder" x="5 ± 10" y="-3 ± 10" roll="10 ± 10" yaw="20 ± 10"/>
      <mount name="arm" order="rpy" x="100 ± 10" y="0 ± 10" z="0 ± 10" a="0 ± 10" b="0 ± 10" c="0 ± 10"/>
    </chain>
    <encoder name="encoder" column="theta" intercept="4" sigma="0.001"/>
    <frame name="E" in="B" sigma="0.01 mm, 0.01 deg"/></talus>)");
  Program truth = program_from(R"(<talus>
    <chain from="B" to="E">
      <revolute name="hinge" theta="encoder" x="9 ± 10" y="-7 ± 10" roll="6 ± 10" yaw="28 ± 10"/>
      <mount name="arm" order="rpy" x="93 ± 10" y="5 ± 10" z="2 ± 10" a="3 ± 10" b="-6 ± 10" c="9 ± 10"/>
    </chain>
    <encoder name="encoder" column="theta" intercept="4" sigma="0.001"/>
    <frame name="E" in="B" sigma="0.01 mm, 0.01 deg"/></talus>)");
  const Recordings recordings = moved(truth, "encoder=-40:40:10", 0);
  AxisFinder finder(program);
  Located located = finder.locate(recordings, all_rows(recordings), once());
  const auto views = finder.body_views(located);
  finder.describe(located, views);
  CHECK(located.axes[0].determined);
  CHECK(located.axes[0].low == doctest::Approx(-36 * deg));
  CHECK(located.axes[0].high == doctest::Approx(44 * deg));
  AxisFinder true_finder(truth);
  const auto expected = numbers(true_finder, truth, views);
  for (std::size_t v = 0; v < 4; ++v)
    CHECK(std::abs(located.axes[0].value[v] - expected[v]) < (v < 2 ? 1e-3 : 1e-5));
}

TEST_CASE("an axis about which nothing turns is said not to be determined") {
  const Program program = program_of(knee);
  AxisFinder finder(program);
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    CAPTURE(seed);
    const Recordings recordings = moved(program, "q1=0:100:2", 1, seed);
    Located located = finder.locate(recordings, all_rows(recordings), once());
    finder.describe(located, finder.body_views(located));
    CHECK(located.axes[0].determined);
    CHECK(!located.axes[1].determined);
    CHECK(located.axes[1].why.starts_with("not determined: "));
    // No anatomical frame is made from it.
    CHECK_THROWS_WITH_AS(
        finder.anatomical_views(located, "flexion", {0, 0}, {"--frames anatomical", 0, 0}),
        doctest::Contains("axis 'rotation' is not determined"), InputError);
  }
  SUBCASE("nor are axes from hardly any motion") {
    const Recordings recordings = moved(program, "q1=0:1:0.25; q2=-1:1:1", 1);
    Located located = finder.locate(recordings, all_rows(recordings), once());
    finder.describe(located, finder.body_views(located));
    CHECK(!located.axes[0].determined);
    CHECK(!located.axes[1].determined);
  }
}

TEST_CASE("anatomical frames lie on the axes as they are at zero flexion") {
  const Program program = program_of(knee);
  const Recordings recordings = moved(program, "q1=0:100:10; q2=-15:15:5", 0);
  AxisFinder finder(program);
  Located located = finder.locate(recordings, all_rows(recordings), once());
  finder.describe(located, finder.body_views(located));
  const auto views = finder.anatomical_views(located, "flexion", {0, 0}, {});
  finder.describe(located, views);
  CHECK(views[0].name == "F_a");
  CHECK(views[1].name == "T_a");
  for (double v : located.axes[0].value) CHECK(std::abs(v) < 1e-9);  // it is its own frame
  const auto& turns = located.axes[1].value;
  CHECK(std::abs(turns[0]) == doctest::Approx(located.apart[0].distance));  // A-P
  CHECK(std::abs(turns[2]) < 1e-9);  // F-E: k is at right angles to the shortest line
  CHECK(std::abs(turns[3]) == doctest::Approx(std::abs(90 * deg - located.apart[0].angle)));
  // i, j, k is right-handed, k along the longitudinal axis rather than against it.
  CHECK(views[0].frame.linear().determinant() == doctest::Approx(1));
  CHECK((views[1].frame.linear().transpose() * located.axes[1].line.direction)[2] > 0.99);

  AxisFinder reversed(program, "", {"flexion"});
  Located again = reversed.locate(recordings, all_rows(recordings), once());
  reversed.describe(again, reversed.body_views(again));
  const auto other = reversed.anatomical_views(again, "flexion", {0, 0}, {});
  CHECK((other[0].frame.linear().col(1) + views[0].frame.linear().col(1)).norm() < 1e-6);
  CHECK((other[0].frame.linear().col(2) - views[0].frame.linear().col(2)).norm() < 1e-6);
}

TEST_CASE("arcs are located on their own; changes and their errors are told") {
  const Program program = program_of(knee);
  Model model = model_of(knee);
  set(model, "flexion.x", "2 ± 10");
  set(model, "flexion.yaw", "3.718 ± 10");
  const Program changed = program_of(model);
  const std::string grid = "q1=0:110:5; q2=-15:15:5";
  std::vector<Recordings> recordings{moved(program, grid, 0), moved(changed, grid, 0)};
  AxisFinder finder(program);
  AxesOptions options;
  options.locate = once();
  options.arcs = parse_arcs("20:80, 50:110", program.units);
  const Recordings actual =
      parse_recordings("flexion.x[mm],flexion.about z[deg]\n1.9,0\n", "a.csv");
  const AxesResult result = find_axes(finder, recordings, options, &actual);
  REQUIRE(result.arcs.size() == 2);
  for (const ArcAxes& arc : result.arcs) {
    CHECK(arc.located[0].fit.poses_fit == 13 * 7);
    REQUIRE(arc.changes.size() == 1);
    CHECK(arc.changes[0][0].value[0] == doctest::Approx(2).epsilon(1e-3));
    CHECK(arc.changes[0][0].value[2] == doctest::Approx(2 * deg).epsilon(5e-3));
    CHECK(std::abs(arc.changes[0][1].value[0]) < 1e-2);
    REQUIRE(arc.errors.size() == 2);
    CHECK(arc.errors[0].bias == doctest::Approx(0.1).epsilon(0.02));
    CHECK(arc.errors[0].rmse == doctest::Approx(0.1).epsilon(0.02));
    CHECK(arc.errors[1].rmse == doctest::Approx(2 * deg).epsilon(5e-3));
  }
  REQUIRE(result.worst.size() == 2);
  CHECK(result.worst[0].arc >= 0);
}

TEST_CASE("the validation fixture does what equations 10 and 11 say") {
  const Program fixture = program_of(isl + "validation.xml");
  Posture posture(fixture);
  const double L = 222.8, D = 7, reference = 2.87;
  auto index = [&](const std::string& sensor) {
    for (std::size_t i = 0; i < fixture.readings.size(); ++i)
      if (fixture.readings[i].sensor == sensor) return i;
    return fixture.readings.size();
  };
  const int Fa = fixture.frame("Fa", {});
  const View view{Eigen::Isometry3d::Identity(), 1, "Fa"};
  double farthest_AP = 0, farthest_PD = 0, farthest_with_last_term = 0;
  int count = 0;
  for (const double PD : {2.87, 5.08, 9.74})
    for (const double AP : {2.87, 5.08, 9.74})
      for (const double VV : {-3 * deg, 0.0, 3 * deg})
        for (const double IE : {-3 * deg, 0.0, 3 * deg}) {
          std::vector<double> readings(fixture.readings.size());
          readings[index("dPD")] = PD, readings[index("dAP")] = AP;
          readings[index("dVV")] = VV, readings[index("dIE")] = IE;
          readings[index("flexion")] = 40 * deg, readings[index("rotation")] = 10 * deg;
          posture.set(readings);
          std::array<double, 4> here{};
          for (const JointAxis& axis : posture.axes())
            if (axis.joint == "flexion_shaft") {
              const Eigen::Isometry3d to_Fa = posture.frame(Fa).inverse();
              here = coordinates_of({to_Fa * axis.point, to_Fa.linear() * axis.direction}, view);
            }
          const double pd = PD - reference, ap = AP - reference;
          const double cross = std::tan(IE) * std::tan(VV);
          const double AP_11 = D - (D + ap) / std::cos(IE) - (L + pd) * cross;
          const double PD_10 = L - (L + pd) / std::cos(VV);  // without the last term
          farthest_AP = std::max(farthest_AP, std::abs(here[0] - AP_11));
          farthest_PD = std::max(farthest_PD, std::abs(here[1] - PD_10));
          farthest_with_last_term =
              std::max(farthest_with_last_term, std::abs(here[1] - (PD_10 - (D + ap) * cross)));
          CHECK(here[3] == doctest::Approx(VV));
          CHECK(std::tan(here[2]) == doctest::Approx(std::tan(IE) / std::cos(VV)));
          ++count;
        }
  CHECK(count == 81);
  CHECK(farthest_AP < 1e-9);
  CHECK(farthest_PD < 1e-9);
  // The last term of equation 10 belongs to the other order of the two turns.
  CHECK(farthest_with_last_term == doctest::Approx((D + 6.87) * std::pow(std::tan(3 * deg), 2)));
}

TEST_CASE("errors of axes in the user's words") {
  CHECK_THROWS_WITH_AS(AxisFinder(program_of(shipped("arm-6r/model.xml"))),
                       doctest::Contains("the model measures no frame"), InputError);
  const Program program = program_of(knee);
  CHECK_THROWS_WITH_AS(AxisFinder(program, "F"),
                       "--of F: no measured frame 'F'\n  expected one of: E\n  did you mean 'E'?",
                       InputError);
  CHECK_THROWS_WITH_AS(AxisFinder(program, "", {"flexoin"}),
                       "--reverse flexoin: no hinge 'flexoin'\n  expected one of: flexion, "
                       "rotation\n  did you mean 'flexion'?",
                       InputError);
  CHECK_THROWS_WITH_AS(parse_arcs("20-80", program.units),
                       "--arcs: '20-80'\n  expected first:last, such as \"20:80, 30:90\"",
                       InputError);
  CHECK_THROWS_WITH_AS(parse_arcs("80:20", program.units),
                       "--arcs: '80:20'\n  expected first below last", InputError);
}
