// Circumstances that effects need: made up for simulated poses, taken from tables, worked out.
#include "framework/calibration/circumstances.h"

#include <doctest/doctest.h>

#include <cmath>

#include "framework/calibration/fit.h"
#include "framework/calibration/simulate.h"
#include "framework/dsl/dsl.h"
#include "tests/support/command.h"

using namespace talus;
using namespace talus::testing;

namespace {

// A heavy arm of two joints; the second turns against its encoder.
std::string arm_with(const std::string& effects, const std::string& gravity = R"(
  <gravity in="base" z="-1"/><payload at="tip" column="payload"/>)") {
  return R"(<talus name="arm">
  <chain from="base" to="tip">
    <dh name="joint1" theta="encoder1" d="100 ± 1" a="300 ± 1" alpha="90 ± 0.5" mass="2 kg"/>
    <dh name="joint2" theta="-encoder2" a="250 ± 1" mass="1 kg"/>
  </chain>)" +
         gravity + R"(
  <encoder name="encoder1" column="theta1" sigma="0.002"/>
  <encoder name="encoder2" column="theta2" sigma="0.002"/>
  <frame name="tip" in="base" sigma="0.01 mm, 0.002 deg"/>)" +
         effects + "</talus>";
}

Program compiled(const std::string& text) {
  Registry registry = Registry::built_in();
  return compile(read_xml(text, "arm.xml", registry), registry);
}

std::vector<std::string> names(const Recordings& r) {
  std::vector<std::string> result;
  for (const RecordedColumn& c : r.columns) result.push_back(c.name);
  return result;
}

const char* kAll = R"(
  <backlash at="encoder2" half_width="0 ± 0.1"/>
  <thermal_drift at="encoder1" rate="0 ± 1" per_degree="0 ± 1"/>
  <joint_compliance at="joint2" compliance="0 ± 0.1"/>
  <encoder_zero_slip at="encoder1" step="0 ± 1" pose="3"/>
  <time_lag lag="0 ± 0.01"/>)";

}  // namespace

TEST_CASE("simulated recordings contain what would be recorded, and nothing that follows from it") {
  const Program plain = compiled(arm_with("")), ill = compiled(arm_with(kAll));
  const Settings poses = random_settings(plain, 12, 4);
  const Recordings without = simulate(plain, poses, {.seed = 5}),
                   with = simulate(ill, random_settings(ill, 12, 4), {.seed = 5});
  CHECK(names(with) == std::vector<std::string>{"pose", "time", "session", "temperature", "payload",
                                                "approach_joint2", "theta1", "theta2", "tip.x",
                                                "tip.y", "tip.z", "tip.qw", "tip.qx", "tip.qy",
                                                "tip.qz"});
  CHECK(names(without).size() == 10);
  // Null amounts change nothing: neither readings, nor noise, nor what is measured.
  for (const RecordedColumn& c : without.columns) {
    CAPTURE(c.name);
    REQUIRE(with.find(c.name));
    CHECK(with.find(c.name)->values == c.values);
  }
  CHECK(with.find("time")->values[11] == 330);
  CHECK(with.find("temperature")->values[11] == 20);
  CHECK(with.find("session")->values[11] == 1);
}

TEST_CASE("a joint is approached in the sense in which it itself moves") {
  const Program program =
      compiled(arm_with("<backlash at='encoder1' half_width='1'/><hysteresis at='encoder2'/>"));
  Settings settings;
  const std::size_t n = program.readings.size();
  for (const auto& [q1, q2] : {std::pair{10., 5.}, {20., 5.}, {15., 8.}, {15., -3.}}) {
    auto& pose = settings.poses.emplace_back(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      if (program.readings[i].sensor == "encoder1") pose[i] = q1 * deg;
      if (program.readings[i].sensor == "encoder2") pose[i] = q2 * deg;
    }
  }
  const Recordings r = simulate(program, settings, {.noise = 0});
  CHECK(r.find("approach_joint1")->values == std::vector<double>{1, 1, -1, -1});
  CHECK(r.find("approach_joint2")->values == std::vector<double>{-1, -1, -1, 1});
  CHECK(r.find("theta1")->values[2] == doctest::Approx(15 * deg));  // the reading is as it was

  const Program rigid = compiled(arm_with(""));
  Settings meant;  // where the arm really was
  for (const auto& [q1, q2] : {std::pair{11., 5.}, {21., 5.}, {14., 8.}, {14., -3.}})
    meant.poses.push_back({q1 * deg, q2 * deg});
  const Recordings there = simulate(rigid, meant, {.noise = 0});
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(r.find("tip.x")->values[k] == doctest::Approx(there.find("tip.x")->values[k]));
}

TEST_CASE("circumstances come from the table where it has them") {
  Program program = compiled(arm_with(kAll));
  const Recordings table = parse_recordings(
      "pose,time[s],temperature[degC],payload[kg],approach_joint2,theta1[deg],theta2[deg]\n"
      "4,10,25,0.5,-1,10,20\n7,10.2,26,1.5,1,11,22\n",
      "poses.csv");
  const Settings settings = with_circumstances(program, settings_from(program, table, 1), &table);
  const Recordings r = simulate(program, settings, {.noise = 0});
  CHECK(r.find("pose")->values == std::vector<double>{4, 7});
  CHECK(r.find("time")->values == std::vector<double>{10, 10.2});
  CHECK(r.find("temperature")->values == std::vector<double>{25, 26});
  CHECK(r.find("payload")->values == std::vector<double>{0.5, 1.5});
  CHECK(r.find("approach_joint2")->values == std::vector<double>{-1, 1});
  for (std::size_t i = 0; i < program.readings.size(); ++i)
    if (program.readings[i].column == "rate:theta1")
      CHECK(settings.poses[1][i] == doctest::Approx(5 * deg));
}

TEST_CASE("what an effect needs and nobody knows is said") {
  auto complaint = [](const std::string& text) {
    try {
      const Program program = compiled(text);
      with_derived(program, parse_recordings("pose,theta1[deg],theta2[deg]\n1,2,3\n", "poses.csv"));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(complaint(arm_with("<joint_compliance at='joint2'/>", ""))
            .find("the load of 'joint2' is not known\n  expected <gravity>") != std::string::npos);
  CHECK(complaint(arm_with("<time_lag lag='0 ?'/>")).find("no column 'time'") != std::string::npos);
  CHECK(complaint(arm_with("<joint_compliance at='joint2'/>")).empty());
}

TEST_CASE("an effect needs what its own amounts depend on") {
  const Program program = compiled(arm_with("<backlash at='encoder2' half_width='0 ± 0.1'/>", ""));
  const Recordings table =
      parse_recordings("approach_joint2,theta1[deg],theta2[deg]\n1,2,3\n", "poses.csv");
  CHECK_NOTHROW(with_derived(program, table));
  CHECK_FALSE(depends_on_loads(program));
  CHECK(
      depends_on_loads(compiled(arm_with("<backlash at='encoder2' half_width_load='0 ± 0.1'/>"))));
}

TEST_CASE("what a table of poses says of its circumstances is kept, needed or not") {
  Program program = compiled(arm_with(""));
  const Recordings table = parse_recordings(
      "approach_joint1,payload[kg],gravity.x,gravity.y,gravity.z,theta1[deg],theta2[deg],other\n"
      "-1,0.5,0,1,0,10,20,7\n1,1.5,,,,11,22,8\n",
      "poses.csv");
  const Recordings r = simulate(
      program, with_circumstances(program, settings_from(program, table, 1), &table), {.noise = 0});
  for (const char* name : {"approach_joint1", "payload", "gravity.y"}) {
    REQUIRE(r.find(name));
    CHECK(r.find(name)->values[0] == table.find(name)->values[0]);
  }
  CHECK(std::isnan(r.find("gravity.y")->values[1]));
  CHECK_FALSE(r.find("other"));
}

TEST_CASE("simulated with effects, calibrated with effects") {
  const Folder folder;
  const std::string effects = R"xml(
  <backlash at="encoder1" half_width="0 ± 0.1"/>
  <joint_compliance name="soft" at="joint2" compliance="0 ± 0.1 deg/(N*m)"/>)xml";
  folder.write("arm.xml", arm_with(effects));
  folder.write("true.xml", arm_with(R"xml(
  <backlash at="encoder1" half_width="0.08"/>
  <joint_compliance name="soft" at="joint2" compliance="0.05 deg/(N*m)"/>)xml"));
  const Run simulated =
      command(folder, "simulate true.xml --poses 60 --seed 3 --recordings poses.csv");
  CHECK(simulated.error == "");
  REQUIRE(simulated.code == 0);
  CHECK(contents(folder / "poses.csv").find("load:") == std::string::npos);
  const Run fitted = command(folder, "calibrate arm.xml poses.csv --out .");
  CHECK(fitted.error == "");
  REQUIRE(fitted.code == 0);
  Registry registry = Registry::built_in();
  const Program after = compile(read_model(folder / "arm-calibrated.xml", registry), registry);
  for (const Parameter& p : after.parameters) {
    CAPTURE(p.name);
    if (p.attribute == "half_width")
      CHECK(p.nominal.value == doctest::Approx(0.08 * deg).epsilon(0.05));
    if (p.attribute == "compliance")
      CHECK(p.nominal.value == doctest::Approx(0.05 * deg / 1e6).epsilon(0.05));
  }
}

TEST_CASE("effects need not be known to check and draw a model") {
  const Folder folder;
  folder.write("arm.xml", arm_with(kAll));
  const Run check = command(folder, "check arm.xml");
  CHECK(check.code == 0);
  CHECK(check.out.find("Circumstances\n  time, temperature, pose, ") != std::string::npos);
  CHECK(command(folder, "draw arm.xml --picture arm.svg").code == 0);
}
