// Loads as columns of the recordings.
#include "framework/calibration/load_columns.h"

#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const char* const xml = R"(<talus>
  <chain from="A" to="B">
    <dh name="upper" theta="q1" a="300" mass="2 kg" com="-150, 0, 0"/>
    <dh name="fore" theta="q2" a="200 ± 1"/></chain>
  <encoder name="q1"/><encoder name="q2"/>
  <gravity y="-1" magnitude="10"/><payload at="B" column="load"/>
  <point name="B" in="A"/></talus>)";

Recordings table(const std::string& text) { return parse_recordings(text, "table.csv"); }

std::vector<double> nominal(const Program& program) {
  std::vector<double> result;
  for (const Parameter& p : program.parameters) result.push_back(p.nominal.value);
  return result;
}

}  // namespace

TEST_CASE("columns of loads, at the parameters given, with the payload of each row") {
  const Program program = program_from(xml);
  const Recordings before = table("q1[deg],q2[deg],load[g]\n0,0,500\n0,90,1000\n0,,500\n0,0,\n");
  const Recordings after = with_loads(program, before, std::vector<double>{250.0});
  CHECK(after.columns.size() == before.columns.size() + 2 * 21);
  const auto& upper = after.get("load:upper.mz", torque).values;
  const auto& fore = after.get("load:fore.mz", torque).values;
  // N mm: 10 m/s^2 times (2 kg at 150 mm, payload at 550 or 300 mm); in kg mm^2/s^2 1000 times.
  CHECK(upper[0] == doctest::Approx(-1e4 * (2 * 150 + 0.5 * 550)));
  CHECK(upper[1] == doctest::Approx(-1e4 * (2 * 150 + 1.0 * 300)));
  CHECK(fore[0] == doctest::Approx(-1e4 * 0.5 * 250));
  CHECK(std::abs(fore[1]) < 1e-9 * 1e6);
  CHECK(std::isnan(upper[2]));
  CHECK(std::isnan(upper[3]));
  CHECK(after.get("load:upper.weight_y", force).values[2] == doctest::Approx(-2e4));
  CHECK(after.get("load:upper.tip_fy", force).values[0] == doctest::Approx(-0.5e4));
  CHECK(after.get("load:upper.tip_mz", torque).values[0] == doctest::Approx(fore[0]));
  CHECK(after.get("load:fore.span_x", length).values[0] == doctest::Approx(250));
  // Newtons where they are written.
  CHECK(after.find("load:fore.fx")->unit.text == "N");
  CHECK(after.find("load:fore.mx")->unit.factor == 1000);
  // Again, at other parameters: in their place.
  const Recordings again = with_loads(program, after, nominal(program));
  CHECK(again.columns.size() == after.columns.size());
  CHECK(again.get("load:fore.span_x", length).values[0] == doctest::Approx(200));
}

TEST_CASE("a payload that was not recorded is zero, and is said to be missing") {
  const Program program = program_from(xml);
  const Recordings before = table("q1[deg],q2[deg]\n0,0\n");
  CHECK(missing_payloads(program, before) == std::vector<std::string>{"load"});
  const Recordings after = with_loads(program, before, nominal(program));
  CHECK(after.get("load:upper.mz", torque).values[0] == doctest::Approx(-1e4 * 2 * 150));
  CHECK(after.get("load:fore.mz", torque).values[0] == 0);
  CHECK_THROWS_AS(with_loads(program, table("q1[deg],q2[deg],load[mm]\n0,0,1\n"), nominal(program)),
                  InputError);
}

TEST_CASE("joints whose loads depend on an unknown have no columns") {
  auto with = [](const std::string& gravity, const std::string& more) {
    const Program program = program_from(R"(<talus><unknown name="u" kind="angle"/>
      <chain from="A" to="C"><dh name="j1" theta="q1" a="300" mass="2 kg"/>
        <dh name="j2" theta="u" a="200"/><dh name="j3" theta="q2" a="50" )" +
                                         more + "/></chain>" + gravity + R"(
      <encoder name="q1"/><encoder name="q2"/><frame name="C" in="A"/></talus>)");
    std::vector<std::string> names;
    for (const int f : loaded_frames(program)) names.push_back(program.frames[f].name);
    return names;
  };
  using Names = std::vector<std::string>;
  CHECK(with("", R"(mass="1 kg")").empty());
  CHECK(with(R"(<gravity z="-1"/>)", "") == Names{"j1"});  // nothing heavy beyond the unknown
  CHECK(with(R"(<gravity z="-1"/>)", R"(mass="1 kg")").empty());
  CHECK(with(R"(<gravity in="C" z="-1"/>)", R"(mass="1 kg")") == Names{"j3"});
  CHECK(with(R"(<gravity z="-1" held_at="C"/>)", "").empty());
  const Program program = program_from(std::string(xml)
                                           .replace(std::string(xml).find("<gravity"), 0, "<!-- ")
                                           .replace(std::string(xml).find("<point") + 5, 0, "-->"));
  CHECK(with_loads(program, table("q1[deg],q2[deg]\n0,0\n"), nominal(program)).columns.size() == 2);
}

TEST_CASE("rows recorded in another mounting have gravity where they say") {
  const Program program = program_from(xml);
  const Recordings before = table(
      "q1[deg],q2[deg],load[kg],gravity.x,gravity.y,gravity.z\n"
      "0,0,1,,,\n0,0,1,0,2,0\n0,0,1,-3,0,0\n0,0,1,0,,-1\n");
  const Recordings after = with_loads(program, before, nominal(program));
  const auto& moment = after.get("load:upper.mz", torque).values;
  const auto& along = after.get("load:upper.fx", force).values;
  CHECK(moment[0] == doctest::Approx(-1e4 * (2 * 150 + 1 * 500)));  // as the model says
  CHECK(moment[1] == doctest::Approx(1e4 * (2 * 150 + 1 * 500)));   // upside down
  CHECK(std::abs(moment[2]) < 1e-6);                                // along the arm
  CHECK(along[2] == doctest::Approx(-1e4 * 3));
  CHECK(std::isnan(moment[3]));
  CHECK_THROWS_AS(
      with_loads(program, table("q1[deg],q2[deg],gravity.x,gravity.y,gravity.z\n0,0,0,0,0\n"),
                 nominal(program)),
      InputError);
  CHECK_THROWS_AS(
      with_loads(program, table("q1[deg],q2[deg],gravity.y\n0,0,1\n"), nominal(program)),
      InputError);
}
