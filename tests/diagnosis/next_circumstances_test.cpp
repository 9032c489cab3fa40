// What to record next is more than where to go: from which side, with which payload, how mounted.
// What cannot be told apart in the recordings at hand is named once what was proposed has been
// recorded.
#include <doctest/doctest.h>

#include <random>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/inverse.h"
#include "framework/diagnosis/mountings.h"
#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;

namespace {

// A boom on a turntable. Its tilt moves little, so that its scale's eccentricity, its second
// harmonic and whatever follows the cosine of the tilt look alike: zero and slope are calibrated.
Model boom(const std::string& heavy, const std::string& more = "") {
  Registry registry = Registry::built_in();
  return read_xml(R"(<talus>
    <chain from="base" to="tool">
      <dh name="pan" theta="q1" d="300" alpha="90 ± 1"/>
      <dh name="tilt" theta="q2" a="500 ± 1" )" +
                      heavy + R"(/></chain>
    <encoder name="q1" intercept="0 ± 1" sigma="0.002" range="-150, 150"/>
    <encoder name="q2" slope="1 ± 0.01" intercept="0 ± 1" sigma="0.002" range="-40, 40"/>
    <gravity z="-1"/>
    <frame name="tool" in="base" sigma="0.02 mm, 0.005 deg"/>)" +
                      more + R"(
    <calibrate residual="position, rotation_vector" of="tool"/></talus>)",
                  "boom.xml", registry);
}

Model with(Model model, const std::string& effect) {
  Registry registry = Registry::built_in();
  for (const Element& e :
       read_xml("<talus>" + effect + "</talus>", "e.xml", registry).root.children)
    model.root.children.push_back(e);
  return model;
}

// Readings at random, `levels` of the tilt (0: any), and further columns of each pose.
Recordings places(int count, int levels, const std::string& columns,
                  const std::function<std::string(double tilt)>& cells) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::string text = "pose,q1[deg],q2[deg]" + columns + "\n";
  for (int k = 0; k < count; ++k) {
    const double pan = 150 * uniform(random), any = 40 * uniform(random);
    const double tilt = levels > 0 ? -40.0 + 80.0 / (levels - 1) * (k % levels) : any;
    text += std::to_string(k + 1) + "," + std::to_string(pan) + "," + std::to_string(tilt) +
            cells(tilt) + "\n";
  }
  return parse_recordings(text, "places.csv");
}

Recordings recorded(const Model& truth, const Recordings& table, std::uint64_t seed) {
  Program program = program_of(truth);
  return simulate(program, with_circumstances(program, settings_from(program, table, 1), &table),
                  {seed, 1, 1});
}

// Both tables, all rows to fit but every third of the first. A cell that a table lacks is empty.
Recordings joined(Recordings all, const Recordings& more) {
  const std::size_t before = all.rows();
  for (const RecordedColumn& c : more.columns)
    if (!all.find(c.name))
      all.columns.push_back({c.name, c.unit, std::vector<double>(before, std::nan("")), {}});
  for (RecordedColumn& c : all.columns) {
    const RecordedColumn* given = more.find(c.name);
    for (std::size_t k = 0; k < more.rows(); ++k)
      c.values.push_back(c.name == "pose" ? static_cast<double>(before + k + 1)
                         : given          ? given->values[k]
                                          : std::nan(""));
  }
  all.lines.insert(all.lines.end(), more.lines.begin(), more.lines.end());
  all.use = std::vector<bool>(all.rows(), true);
  for (std::size_t k = 2; k < before; k += 3) (*all.use)[k] = false;
  return all;
}

bool any_says(const NextRecordings& next, const std::string& words) {
  return std::any_of(next.poses.begin(), next.poses.end(),
                     [&](const NextPose& p) { return p.how.find(words) != std::string::npos; });
}

const std::vector<std::string> by_load = {"joint_compliance", "encoder_eccentricity",
                                          "encoder_second_harmonic"};
const std::vector<std::string> by_side = {"backlash", "encoder_eccentricity",
                                          "encoder_second_harmonic"};
const std::string sags = "<joint_compliance at='tilt' compliance='0.015 deg/(N*m)'/>";
const std::string plays = "<backlash at='tilt' half_width='0.02'/>";

void check_named(const Diagnosed& d, const std::string& effect) {
  CAPTURE(d.diagnosis.statement);
  CHECK(d.diagnosis.verdict == Verdict::explained);
  REQUIRE(d.diagnosis.findings.size() == 1);
  CHECK(d.diagnosis.findings[0].effect == effect);
  CHECK(d.diagnosis.findings[0].location == "tilt");
}

}  // namespace

TEST_CASE("play that one side hides is seen once poses are approached from the other") {
  const Model truth = with(boom(R"(mass="1 kg")"), plays);
  const auto up = [](double) { return ",1"; };
  const Diagnosed d =
      diagnosed(boom(""), recorded(truth, places(60, 0, ",approach_tilt", up), 4), by_side);
  CHECK(d.diagnosis.verdict == Verdict::nothing_missing);
  const NextRecordings& next = d.advice.next;
  CAPTURE(next.statement);
  REQUIRE(next.poses.size() == 8);
  CHECK(any_says(next, "tilt from above"));
  check_named(diagnosed(boom(""), joined(d.recordings, recorded(truth, next.table, 5)), by_side),
              "backlash");
}

TEST_CASE("play that follows the posture is told from a scale error by reversals") {
  const Model truth = with(boom(R"(mass="1 kg")"), plays);
  const auto from_the_middle = [](double tilt) { return tilt < -1 ? ",-1" : ",1"; };
  const Diagnosed d = diagnosed(
      boom(""), recorded(truth, places(60, 3, ",approach_tilt", from_the_middle), 4), by_side);
  CAPTURE(d.diagnosis.statement);
  REQUIRE(d.diagnosis.verdict == Verdict::ambiguous);
  const NextRecordings& next = d.advice.next;
  REQUIRE_FALSE(next.targets.empty());
  CHECK(next.targets[0].told_before < 12);
  CHECK(next.targets[0].told_after > 12);
  CHECK(any_says(next, "tilt from "));
  for (const NextPose& p : next.poses) CHECK(p.gain >= 0);
  check_named(diagnosed(boom(""), joined(d.recordings, recorded(truth, next.table, 5)), by_side),
              "backlash");
}

TEST_CASE("a joint that gives way is told from a scale error by another payload") {
  const Model nominal = boom("", R"(<payload at="tool" column="payload"/>)");
  const Model truth = with(nominal, sags);
  const auto two = [](double) { return ",2"; };
  const Diagnosed d =
      diagnosed(nominal, recorded(truth, places(60, 0, ",payload[kg]", two), 4), by_load);
  CAPTURE(d.diagnosis.statement);
  REQUIRE(d.diagnosis.verdict == Verdict::ambiguous);
  const NextRecordings& next = d.advice.next;
  CHECK(next.mounting.empty());
  CHECK(any_says(next, "without payload"));
  REQUIRE_FALSE(next.targets.empty());
  CHECK(next.targets[0].told_before < 12);
  CHECK(next.targets[0].told_after > 12);
  check_named(diagnosed(nominal, joined(d.recordings, recorded(truth, next.table, 5)), by_load),
              "joint_compliance");
}

TEST_CASE("a stated range of a payload is offered, whatever was hung there so far") {
  const auto none = [](double) { return ",0"; };
  auto heaviest = [&](const std::string& range) {
    const Model model = boom(R"(mass="4 kg" com="-250, 0, 0")",
                             "<payload at='tool' column='payload' " + range + "/>");
    const Diagnosed d = diagnosed(
        model, recorded(with(model, sags), places(60, 0, ",payload[kg]", none), 4), by_load);
    const RecordedColumn* c = d.advice.next.table.find("payload");
    return c ? *std::max_element(c->values.begin(), c->values.end()) : -1;
  };
  CHECK(heaviest("") == 0);
  CHECK(heaviest("range='0, 3 kg'") == 3);
  CHECK_THROWS_AS(program_of(boom("", "<payload at='tool' column='p' range='3 kg, 1 kg'/>")),
                  InputError);
}

TEST_CASE("what no pose tells apart another mounting does") {
  const Model nominal = boom(R"(mass="4 kg" com="-250, 0, 0")");
  const Model truth = with(nominal, sags);
  const auto nothing = [](double) { return ""; };
  const Diagnosed d = diagnosed(nominal, recorded(truth, places(60, 0, "", nothing), 4), by_load);
  CAPTURE(d.diagnosis.statement);
  REQUIRE(d.diagnosis.verdict == Verdict::ambiguous);
  const NextRecordings& next = d.advice.next;
  CAPTURE(next.statement);
  CHECK(next.mounting.starts_with("base turned "));
  CHECK(any_says(next, next.mounting));
  REQUIRE(next.table.find("gravity.x"));
  CHECK(next.targets[0].told_before < 12);
  CHECK(next.targets[0].told_after > 12);
  const Recordings all = joined(d.recordings, recorded(truth, next.table, 5));
  REQUIRE(all.find("gravity.z"));
  check_named(diagnosed(nominal, all, by_load), "joint_compliance");
}

TEST_CASE("mountings: each once, none where the base would have to be found anew") {
  const auto all = mountings(program_of(boom(R"(mass="1 kg")")));
  REQUIRE(all.size() == 5);  // about z nothing changes
  CHECK(all[0].words == "base turned 90 deg about its x axis");
  // x stays, y points up, z to where -y was: what hangs along -z pulls along -y of the base.
  CHECK((all[0].down - Eigen::Vector3d(0, -1, 0)).norm() < 1e-12);
  CHECK((all[4].down - Eigen::Vector3d(0, 0, 1)).norm() < 1e-12);
  CHECK(mountings(program_of(boom(""))).empty());  // nothing heavy
  CHECK(mountings(program_of(shipped("arm-6r/model.xml"))).empty());
}
