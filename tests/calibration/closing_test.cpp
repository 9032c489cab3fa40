// Closed loops: postures that close them, with what effects and gaps do to them, and recordings of
// these.
#include "framework/calibration/closing.h"

#include <cmath>

#include "framework/kinematics/pose_values.h"
#include "tests/support/diagnosed.h"
#include "tests/support/loops.h"

using namespace talus;
using namespace talus::testing;

namespace {

// How far crank and rocker pin are apart, posture by posture.
std::vector<double> rods(const Program& program, const Settings& settings) {
  PoseValues pins(program,
                  program.between(program.frame("rocker_pin", {}), program.frame("crank_pin", {})));
  std::vector<double> result;
  for (const auto& pose : settings.poses) {
    const Vector3<double> p = pins(slots_at(program, pose)).translation;
    result.push_back(std::hypot(p[0], p[1]));
  }
  return result;
}

}  // namespace

TEST_CASE("drawn postures of a four-bar linkage close its loop within the sensors' ranges") {
  Program program = program_of(four_bar());
  REQUIRE(has_loops(program));
  const Settings settings = random_closed_settings(program, 25, {.seed = 3});
  REQUIRE(settings.poses.size() == 25);
  for (const double rod : rods(program, settings)) CHECK(rod == doctest::Approx(130).epsilon(1e-7));
  double lowest = 1e9, highest = -1e9;
  for (const auto& pose : settings.poses) {
    lowest = std::min(lowest, pose[0]), highest = std::max(highest, pose[0]);
    CHECK(pose[1] > 60 * deg - 1e-9);
  }
  CHECK(highest - lowest > 200 * deg);  // not one posture again and again
  CHECK(random_closed_settings(program, 25, {.seed = 3}).poses == settings.poses);
  CHECK(program.readings.size() == 2);  // as it was
  CHECK(program.rows.size() == 1);
}

TEST_CASE("what is held stays, and what cannot be closed is said") {
  Program program = program_of(four_bar());
  Settings drawn;
  for (const double crank : {-2.0, 0.0, 1.0}) drawn.poses.push_back({crank, 1.5});
  Closed closed = close_loops(program, drawn, {.held = {true, false}, .attempts = 40});
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(closed.reached[k]);
    CHECK(closed.settings.poses[k][0] == drawn.poses[k][0]);
  }
  for (const double rod : rods(program, closed.settings))
    CHECK(rod == doctest::Approx(130).epsilon(1e-7));
  closed = close_loops(program, drawn, {.held = {true, true}});
  CHECK(closed.settings.poses == drawn.poses);

  Model far = four_bar();
  set(far, "post.x", "500");
  Program never = program_of(far);
  CHECK_THROWS_WITH_AS(random_closed_settings(never, 5, {}),
                       doctest::Contains("no posture drawn from the sensors' ranges"), InputError);
}

TEST_CASE("effects are part of the loop") {
  Program plain = program_of(four_bar());
  Program ill = program_of(
      with_elements(four_bar(), R"(<encoder_eccentricity at="encoder1" sine="2" cosine="1"/>)"));
  const Settings with = random_closed_settings(ill, 10, {.seed = 3});
  for (const double rod : rods(ill, with)) CHECK(rod == doctest::Approx(130).epsilon(1e-7));
  double off = 0;
  for (const double rod : rods(plain, with)) off = std::max(off, std::abs(rod - 130));
  CHECK(off > 0.5);
}

TEST_CASE("with noise a loop is open by its sigma") {
  Program program = program_of(four_bar());
  ClosingOptions options;
  options.noise = 1;
  const Settings settings = random_closed_settings(program, 400, options);
  double squares = 0;
  for (const double rod : rods(program, settings)) squares += std::pow((rod - 130) / 0.02, 2);
  CHECK(squares / 400 == doctest::Approx(1).epsilon(0.2));
}

TEST_CASE("recordings have the columns by which rows are grouped") {
  Program arm = program_of(shipped("arm-panda/model.xml"));
  const Recordings sockets = simulate(arm, random_closed_settings(arm, 5, {}), {});
  for (const double v : sockets.get("location", number).values) CHECK(v == 1);
  const Program mount = program_of(shipped("mount-altaz/model.xml"));
  const Recordings stars = recorded(mount, 4, 1);
  CHECK(stars.get("star", number).values == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("a measuring machine's errors are in the recordings that are simulated") {
  const Program plain = program_of(shipped("isl-bonny-2013/model.xml"));
  const Program ill = program_of(with_elements(model_of(shipped("isl-bonny-2013/model.xml")),
                                               R"(<measurement_scale x="0.01"/>)"));
  const Recordings a = recorded(plain, 3, 1, 0), b = recorded(ill, 3, 1, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(b.get("E.x", length).values[k] ==
          doctest::Approx(1.01 * a.get("E.x", length).values[k]).epsilon(1e-12));
    CHECK(b.get("E.y", length).values[k] == a.get("E.y", length).values[k]);
  }
  // Of a direction too: x gains of y.
  const Program mount = program_of(shipped("mount-altaz/model.xml"));
  const Program sheared = program_of(with_elements(model_of(shipped("mount-altaz/model.xml")),
                                                   R"(<measurement_squareness xy="1"/>)"));
  const Recordings c = recorded(mount, 3, 1, 0), d = recorded(sheared, 3, 1, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = c.get("d.x", number).values[k], y = c.get("d.y", number).values[k],
                 z = c.get("d.z", number).values[k], seen = x + std::sin(1 * deg) * y;
    CHECK(d.get("d.x", number).values[k] ==
          doctest::Approx(seen / std::hypot(seen, y, z)).epsilon(1e-9));
  }
}
