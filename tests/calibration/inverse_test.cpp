// Coordinates recovered from tables: given, solved for from measured features, or some of each.
#include "framework/calibration/inverse.h"

#include "framework/kinematics/pose_values.h"
#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

// An arm with one joint that is sensed and one that is not.
const char* const mixed = R"(<talus>
  <unknown name="nod" kind="angle" value="5" per="pose"/>
  <chain from="B" to="E">
    <dh name="shoulder" theta="turn" d="20" a="100" alpha="70"/>
    <dh name="wrist" theta="nod" d="5" a="60" alpha="0"/>
  </chain>
  <encoder name="turn" range="-80, 80" sigma="0.01"/>
  <frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/>
</talus>)";

void drop(Recordings& table, const std::string& name) {
  REQUIRE(std::erase_if(table.columns, [&](const RecordedColumn& c) { return c.name == name; }) >
          0);
}

double farthest(const Settings& a, const Settings& b) {
  REQUIRE(a.poses.size() == b.poses.size());
  double most = 0;
  for (std::size_t k = 0; k < a.poses.size(); ++k)
    for (std::size_t i = 0; i < a.poses[k].size(); ++i) {
      const double d = std::abs(a.poses[k][i] - b.poses[k][i]);
      if (!(d <= most)) most = d;
    }
  return most;
}

}  // namespace

TEST_CASE("latent angles of a knee and an ankle come back from its measured frames") {
  for (const char* model : {"knee-two-axis/model.xml", "ankle-storey-2006/model.xml"}) {
    CAPTURE(model);
    Program program = program_of(shipped(model));
    const Settings set = random_settings(program, 40, 3);
    const Recordings table = simulate(program, set, {.noise = 0});
    const Recovered found = recover(program, table, Reach::nearest, 1);
    CHECK(found.solved == std::vector<std::string>{"q1", "q2"});
    CHECK(found.misfit < 1e-6);
    CHECK(farthest(found.settings, set) < 1e-9);
    CHECK(farthest(settings_from(program, table, 2), set) < 1e-9);
  }
}

TEST_CASE("with noise the nearest posture is found, and the misfit is that of the instruments") {
  Program program = program_of(shipped("ankle-storey-2006/model.xml"));
  const Settings set = random_settings(program, 300, 3);
  const Recordings table = simulate(program, set, {.seed = 4});
  const Recovered found = recover(program, table, Reach::nearest, 1);
  CHECK(farthest(found.settings, set) < 1.5 * deg);
  CHECK(found.misfit == doctest::Approx(std::sqrt(4 / 6.0)).epsilon(0.05));  // 2 of 6 are used up
  const Recovered again = recover(program, table, Reach::nearest, 2);
  CHECK(again.settings.poses == found.settings.poses);
  CHECK_THROWS_WITH_AS(recover(program, table, Reach::exactly, 1),
                       doctest::Contains("cannot be reached"), InputError);
}

TEST_CASE("a table with readings is taken at its word; what it lacks is solved for") {
  Program program = program_from(mixed);
  const Program before = program_from(mixed);
  const Settings set = random_settings(program, 30, 7);
  Recordings table = simulate(program, set, {.noise = 0});

  Recovered found = recover(program, table, Reach::nearest, 1);  // the unknown
  CHECK(found.solved == std::vector<std::string>{"nod"});
  CHECK(farthest(found.settings, set) < 1e-9);

  drop(table, "turn");  // and the reading
  found = recover(program, table, Reach::nearest, 1);
  CHECK(found.solved == std::vector<std::string>{"turn", "nod"});
  CHECK(farthest(found.settings, set) < 1e-9);

  RecordedColumn nod{
      "nod", *parse_unit("deg"), {}, {}};  // the unknown has a column, wrong by 1 deg
  for (const auto& pose : set.poses) nod.values.push_back(pose[1] + 1 * deg);
  table.columns.push_back(nod);
  found = recover(program, table, Reach::nearest, 1);
  CHECK(found.solved == std::vector<std::string>{"turn"});
  CHECK(found.settings.poses[0][1] == nod.values[0]);
  CHECK(found.misfit > 1);

  CHECK(program.readings.size() == before.readings.size());
  CHECK(program.unknowns.size() == before.unknowns.size());
  CHECK(program.unknowns[0].start.value == before.unknowns[0].start.value);
  CHECK(program.parameters.size() == before.parameters.size());
  CHECK(program.rows.size() == before.rows.size());
}

TEST_CASE("rows that lack values have no coordinates; the others are not disturbed") {
  Program program = program_from(mixed);
  const Settings set = random_settings(program, 9, 7);
  Recordings table = simulate(program, set, {.noise = 0});
  column(table, "E.y").values[4] = std::nan("");
  for (const char* name : {"E.x", "E.y", "E.z", "E.qw"})
    column(table, name).values[6] = std::nan("");
  column(table, "turn").values[2] = std::nan("");
  const Recovered found = recover(program, table, Reach::nearest, 1);
  for (std::size_t k : {0u, 1u, 3u, 4u, 5u, 7u, 8u}) {
    CAPTURE(k);
    CHECK(std::abs(found.settings.poses[k][1] - set.poses[k][1]) < 1e-9);
  }
  CHECK(std::isnan(found.settings.poses[6][1]));
  CHECK(std::isnan(found.settings.poses[2][0]));
  CHECK(std::isnan(found.settings.poses[2][1]));
  CHECK_THROWS_WITH_AS(recover(program, table, Reach::exactly, 1),
                       doctest::Contains("lacks measured values"), InputError);
}

TEST_CASE("a table from which a coordinate cannot be had is refused, and the program is unharmed") {
  Program program = program_from(mixed);
  Recordings table = simulate(program, random_settings(program, 5, 7), {.noise = 0});
  drop(table, "E.qx");  // nothing whole is measured any more
  column(table, "turn").name = "trun";
  CHECK_THROWS_WITH_AS(recover(program, table, Reach::nearest, 1),
                       doctest::Contains("did you mean 'trun'?"), InputError);
  CHECK(program.rows.size() == 6);

  Program ankle = program_of(shipped("ankle-storey-2006/model.xml"));
  CHECK_THROWS_WITH_AS(recover(ankle, table, Reach::nearest, 1),
                       doctest::Contains("there is no column 'q1'"), InputError);

  Program few = program_from(R"(<talus>
    <unknown name="a" kind="angle"/><unknown name="b" kind="angle"/>
    <chain from="B" to="E"><dh name="j" theta="a" a="50" alpha="90"/><dh name="k" theta="b" a="30"/></chain>
    <length name="P" in="B" at="E" sigma="1"/></talus>)");
  const Recordings one = simulate(few, random_settings(few, 5, 7), {.noise = 0});
  CHECK_THROWS_WITH_AS(recover(few, one, Reach::nearest, 1),
                       doctest::Contains("2 coordinates are missing"), InputError);
}

TEST_CASE("a reading is brought within half a turn where that is the same posture only") {
  for (const auto& [slope, same] : {std::pair{"1", true}, {"0.9", false}}) {
    Program program =
        program_from(std::string(R"(<talus><chain from="B" to="E">
      <dh name="j" theta="q" a="100"/></chain>
      <encoder name="q" range="-400, 400" slope=")") +
                     slope + R"("/><frame name="E" in="B" sigma="0.1 mm, 0.1 deg"/></talus>)");
    const Settings set{{{200 * deg}, {-190 * deg}, {30 * deg}}};
    const Recordings table = [&] {
      Recordings t = simulate(program, set, {.noise = 0});
      drop(t, "q");
      return t;
    }();
    const Recovered found = recover(program, table, Reach::exactly, 1);
    PoseValues reached(program, program.between(0, 1));
    for (std::size_t k = 0; k < 3; ++k) {
      const PlainPose a = reached(slots_at(program, set.poses[k])),
                      b = reached(slots_at(program, found.settings.poses[k]));
      CHECK(std::abs(a.translation[0] - b.translation[0]) < 1e-6);
      if (same) CHECK(std::abs(found.settings.poses[k][0]) <= 180 * deg);
    }
  }
}
