// What a diagnosis is followed by: what could have been seen, and which poses would show it.
#include "framework/diagnosis/advice.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "framework/calibration/inverse.h"
#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string isl = shipped("isl-bonny-2013/model.xml");
const std::vector<std::string> encoders = {"encoder_eccentricity", "encoder_second_harmonic",
                                           "backlash"};

const SeenSuspect& suspect(const Seen& seen, const std::string& effect, const std::string& at) {
  for (const SeenSuspect& s : seen.suspects)
    if (s.effect == effect && s.location == at) return s;
  throw InputError("no suspect " + effect + " at " + at);
}

const NextTarget& target(const NextRecordings& next, const std::string& effect,
                         const std::string& at) {
  for (const NextTarget& t : next.targets)
    if (t.effect == effect && t.location == at) return t;
  throw InputError("no target " + effect + " at " + at);
}

}  // namespace

TEST_CASE("what a fixture hides is said, and the next poses show it") {
  // An eccentricity that leaves nothing in the fixture's poses.
  const std::string effect = "<encoder_eccentricity at='encoder3' sine='0.2' cosine='0.2'/>";
  const Diagnosed d = diagnosed(isl, isl_recordings(effect), encoders);
  CHECK(d.diagnosis.verdict == Verdict::nothing_missing);

  const SeenSuspect& hidden = suspect(d.advice.seen, "encoder_eccentricity", "encoder3");
  CHECK(hidden.amount == "amplitude");
  CHECK(hidden.unit == "deg");
  CHECK(hidden.typical == doctest::Approx(0.1));
  CHECK(hidden.smallest > 0.3);  // more than what is there
  CHECK(hidden.rival == "encoder_second_harmonic");
  CHECK(hidden.imitates > 0.5);
  // The five blind spots, with this linkage's own figures.
  REQUIRE(d.advice.seen.blind.size() == 5);
  CHECK(d.advice.seen.blind[0].statement.find("takes up all of it") != std::string::npos);
  CHECK(d.advice.seen.blind[1].statement.find("joint3 turns 55 deg") != std::string::npos);
  CHECK(d.advice.seen.blind[3].statement.find("approach) was not recorded") != std::string::npos);

  // The next poses: the worst of all targets gets better, this one is then seen.
  const NextRecordings& next = d.advice.next;
  REQUIRE(next.poses.size() == 8);
  CHECK(next.after > next.before);
  const NextTarget& then = target(next, "encoder_eccentricity", "encoder3");
  CHECK(then.smallest_before == doctest::Approx(hidden.smallest).epsilon(0.5));
  CHECK(then.smallest_after < 0.15);
  CHECK(next.assumed.size() == 6);
  for (const NextPose& pose : next.poses) CHECK_FALSE(pose.purposes.empty());

  // Recorded, they do show it.
  Model with = model_of(shipped("isl-bonny-2013/published.xml"));
  Registry registry = Registry::built_in();
  for (const Element& e :
       read_xml("<talus>" + effect + "</talus>", "e.xml", registry).root.children)
    with.root.children.push_back(e);
  Program truth = program_of(with);
  const Recordings more = simulate(truth, settings_from(truth, next.table, 1), {9, 1, 1});
  Recordings all = d.recordings;
  for (RecordedColumn& c : all.columns)
    c.values.insert(c.values.end(), more.find(c.name)->values.begin(),
                    more.find(c.name)->values.end());
  all.lines.insert(all.lines.end(), more.lines.begin(), more.lines.end());
  all.use = std::vector<bool>(all.rows(), true);
  const Diagnosed again = diagnosed(isl, all, encoders);
  REQUIRE(again.diagnosis.findings.size() == 1);
  CHECK(again.diagnosis.findings[0].effect == "encoder_eccentricity");
  CHECK(again.diagnosis.findings[0].location == "encoder3");
}

TEST_CASE("where rivals cannot be told apart the next poses do it") {
  const Diagnosed d = diagnosed(
      isl, isl_recordings("<encoder_eccentricity at='encoder2' sine='2.2' cosine='0'/>", 7),
      encoders);
  REQUIRE(d.diagnosis.verdict == Verdict::ambiguous);
  const NextRecordings& next = d.advice.next;
  REQUIRE(next.targets.size() == 1);
  REQUIRE(next.targets[0].rivals.size() == 1);
  CHECK(next.targets[0].told_before < 12);
  CHECK(next.targets[0].told_after > 12);
  REQUIRE(next.poses.size() == 8);
  CHECK(next.poses[0].purposes[0].starts_with("tell encoder "));
}

TEST_CASE("the curve of a finding is there before the effect is in the model, and gone after") {
  const Diagnosed d = diagnosed(
      isl, isl_recordings("<encoder_eccentricity at='encoder1' sine='1' cosine='1'/>"), encoders);
  REQUIRE(d.diagnosis.findings.size() == 1);
  REQUIRE(d.advice.curves.size() == 1);
  const Curve& curve = d.advice.curves[0];
  CHECK(curve.x == "encoder1");
  CHECK(curve.y_unit == "deg");
  REQUIRE(curve.points.size() > 5);
  double before = 0, after = 0;
  int count = 0;
  for (const CurvePoint& p : curve.points) {
    before += std::pow(p.before / p.std, 2), after += std::pow(p.after / p.std, 2);
    count += p.count;
    CHECK(p.fitted == doctest::Approx(p.before - p.after));
  }
  CHECK(count == static_cast<int>(d.split.fit.size()));
  CHECK(before > 10 * after);
  // Narrower bins of the same poses. Two amounts answer to the noise in two directions, less what
  // the geometry takes up.
  CHECK(curve.fine.size() >= curve.points.size());
  int fine = 0;
  double moved = 0;
  for (const CurvePoint& p : curve.fine) {
    fine += p.count, moved += std::pow(p.fitted_std / p.std, 2);
    CHECK(p.fitted_std < p.std);
  }
  CHECK(fine == count);
  CHECK(moved > 0.2);
  CHECK(moved < 2);
  CHECK(after < 3 * static_cast<double>(curve.points.size()));
  CHECK(std::is_sorted(curve.points.begin(), curve.points.end(),
                       [](const CurvePoint& a, const CurvePoint& b) { return a.x < b.x; }));
}

TEST_CASE("next poses keep to stated ranges and give the unknowns of a pose") {
  const std::string ankle = shipped("ankle-storey-2006/model.xml");
  const Program program = program_of(ankle);
  const Diagnosed d = diagnosed(
      ankle, simulate(program, random_settings(program, 60, 3), {4, 1, 1}), {"coupled_motion"});
  const NextRecordings& next = d.advice.next;
  CAPTURE(next.statement);
  CHECK_FALSE(next.statement.empty());
  for (const NextPose& pose : next.poses) CHECK(pose.coordinates.size() == next.names.size());

  const std::string arm = shipped("arm-6r/model.xml");
  const Program six = program_of(arm);
  const Diagnosed a = diagnosed(arm, simulate(six, random_settings(six, 40, 3), {4, 1, 1}));
  CHECK(a.advice.next.assumed.empty());
  REQUIRE_FALSE(a.advice.next.poses.empty());
  for (const NextPose& pose : a.advice.next.poses)
    for (std::size_t i = 0; i < six.readings.size(); ++i) {
      CHECK(pose.coordinates[i] >= six.readings[i].range->first);
      CHECK(pose.coordinates[i] <= six.readings[i].range->second);
    }
}
