// Whole diagnoses where no full pose is measured: directions alone, scalars, closed loops of which
// nothing is measured at all.
#include <cmath>

#include "framework/calibration/circumstances.h"
#include "framework/calibration/closing.h"
#include "tests/support/diagnosed.h"
#include "tests/support/loops.h"

using namespace talus;
using namespace talus::testing;

namespace {

// A diagnosis of `model`, recorded by a device whose parameters lie within its tolerances and that
// has these effects.
Diagnosed of(const Model& model, const std::string& effects, int poses, std::uint64_t seed,
             double share = 0.5) {
  Program truth = program_of(with_elements(model, effects));
  draw_truth(truth, seed, share);
  if (!has_loops(truth)) return diagnosed(model, recorded(truth, poses, seed));
  const ClosingOptions options{.noise = 1, .seed = seed};
  return diagnosed(model,
                   simulate(truth, random_closed_settings(truth, poses, options), {.seed = seed}));
}

bool suspected(const Diagnosed& d, const std::string& effect) {
  const auto& all = d.advice.seen.suspects;
  return std::any_of(all.begin(), all.end(),
                     [&](const SeenSuspect& s) { return s.effect == effect; });
}

const Finding& only(const Diagnosed& d, const std::string& name) {
  CHECK(d.diagnosis.verdict == Verdict::explained);
  REQUIRE(named(d.diagnosis) == name);
  return d.diagnosis.findings[0];
}

}  // namespace

TEST_CASE(
    "directions alone: effects of a telescope mount are named, and none where there is none") {
  const Model mount = model_of(shipped("mount-altaz/model.xml"));
  const Diagnosed none = of(mount, "", 100, 1);
  CHECK(none.diagnosis.verdict == Verdict::nothing_missing);
  CHECK(none.diagnosis.findings.empty());
  // Lengths are not seen: what acts on them alone is no suspect.
  CHECK(!suspected(none, "probe_radius"));
  CHECK(suspected(none, "measurement_squareness"));
  CHECK(none.advice.seen.blind.at(0).statement.find("no lengths are measured") !=
        std::string::npos);

  const Diagnosed turn =
      of(mount, R"(<encoder_eccentricity at="encoder1" sine="0.002" cosine="0.001"/>)", 100, 2);
  const Finding& off = only(turn, "encoder_eccentricity@encoder1");
  CHECK(std::abs(off.accepted.amounts[0] - 0.002 * deg) < 4 * off.accepted.std[0]);

  const Diagnosed tilts =
      of(mount, R"(<axis_tilt_wobble at="azimuth" x_sine="0.002" order="2"/>)", 100, 3);
  only(tilts, "axis_tilt_wobble@azimuth");

  const Diagnosed skew = of(mount, R"(<measurement_squareness xy="0.003"/>)", 100, 4);
  const Finding& shear = only(skew, "measurement_squareness@measurement");
  CHECK(std::abs(shear.accepted.amounts[0] - 0.003 * deg) < 4 * shear.accepted.std[0]);
}

// The tube droops; the bearing of the azimuth axis that tilts under the same moment is its twin. A
// wobble of half a degree, with axes a thousand uncertainties off, imitates it: what the screening,
// which is linear, does not see must be paid for all the same.
TEST_CASE("directions alone: a tube that droops is no wobble") {
  const Model mount = model_of(shipped("mount-altaz/model.xml"));
  for (const std::uint64_t seed : {1, 4, 8}) {
    CAPTURE(seed);
    const Diagnosed d =
        of(mount, R"x(<joint_compliance at="elevation" compliance="6e-7 deg/(N*m)"/>)x", 80, seed,
           0.02);
    REQUIRE(d.diagnosis.findings.size() == 1);
    const Finding& f = d.diagnosis.findings[0];
    double droops = f.effect.ends_with("compliance") ? f.probability : 0;
    for (const NamedRival& r : f.rivals)
      if (r.effect.ends_with("compliance")) droops += r.probability;
    CHECK(droops > 0.9);
    CHECK(d.diagnosis.verdict == Verdict::ambiguous);
  }
}

TEST_CASE("directions alone: of a shift only the turn is told") {
  const Model mount = model_of(shipped("mount-altaz/model.xml"));
  Program truth = program_of(with_elements(mount, R"(<fixture_shift session="2" rx="0.003"/>)"));
  const Settings settings = random_settings(truth, 100, 5);
  Recordings table;
  std::vector<double> sessions;
  for (int k = 0; k < 100; ++k) {
    table.lines.push_back(k + 2);
    sessions.push_back(k < 50 ? 1 : 2);
  }
  add_column(table, "session", sessions);
  const Diagnosed d =
      diagnosed(mount, simulate(truth, with_circumstances(truth, settings, &table), {.seed = 5}));
  const Finding& shift = only(d, "fixture_shift@fixture");
  CHECK(shift.accepted.way.amounts == std::vector<std::string>{"rx", "ry", "rz"});
  CHECK(std::abs(shift.accepted.amounts[0] - 0.003 * deg) < 4 * shift.accepted.std[0]);
}

TEST_CASE("lengths and angles of a direction: effects of two hinges are named") {
  Model limbs = model_of(shipped("limbs-storey-2006/model.xml"));
  std::erase_if(limbs.root.children,
                [](const Element& e) { return e.tag == "frame" || e.tag == "calibrate"; });
  limbs = with_elements(limbs, R"(
    <direction_angles name="middle_z" columns="m" in="proximal" at="middle" sigma="0.1"/>
    <length name="L" in="proximal" at="middle" sigma="0.1"/>
    <direction_angles name="IDC" in="proximal" at="distal" sigma="0.1"/>
    <length name="P" in="proximal" at="distal" sigma="0.1"/>)");
  only(of(limbs, R"(<encoder_eccentricity at="rotation1" sine="0.5" cosine="0.4"/>)", 100, 3),
       "encoder_eccentricity@rotation1");
  only(of(limbs, R"(<axis_tilt_wobble at="joint1" x_sine="0.5" order="2"/>)", 100, 3),
       "axis_tilt_wobble@joint1");
  CHECK(of(limbs, "", 100, 3).diagnosis.verdict == Verdict::nothing_missing);
}

TEST_CASE("a four-bar linkage that nothing measures: the crank's encoder is off its centre") {
  const Diagnosed none = of(four_bar(), "", 150, 1);
  CHECK(none.diagnosis.verdict == Verdict::nothing_missing);
  // Nothing is measured: no measuring machine and no markers can be wrong.
  CHECK(!suspected(none, "probe_radius"));
  CHECK(!suspected(none, "measurement_scale"));
  CHECK(!suspected(none, "soft_tissue_artefact"));
  const Diagnosed ill =
      of(four_bar(), R"(<encoder_eccentricity at="encoder1" sine="0.8" cosine="0.5"/>)", 150, 2);
  const Finding& off = only(ill, "encoder_eccentricity@encoder1");
  CHECK(ill.diagnosis.after.heldout_rms < 1.2);
  CHECK(std::abs(off.accepted.amounts[0] - 0.8 * deg) < 4 * off.accepted.std[0]);
}

TEST_CASE("a spatial linkage on its fixture, the loop closed at the clamps") {
  const Model loop = isl_on_fixture();
  CHECK(of(loop, "", 80, 1).diagnosis.verdict == Verdict::nothing_missing);
  const Diagnosed ill =
      of(loop, R"(<encoder_eccentricity at="flexion" sine="0.6" cosine="0.4"/>)", 80, 2);
  only(ill, "encoder_eccentricity@flexion");
  // Poses to be recorded next close the loop as well.
  Program program = program_of(loop);
  for (std::size_t i = 0; i < program.parameters.size(); ++i)
    program.parameters[i].nominal.value = ill.diagnosis.baseline.x[i];
  const Settings next = settings_from(program, ill.advice.next.table, 1);
  Closed closed = close_loops(program, next);
  REQUIRE(!next.poses.empty());
  for (std::size_t k = 0; k < next.poses.size(); ++k)
    for (std::size_t i = 0; i < next.poses[k].size(); ++i)
      CHECK(std::abs(closed.settings.poses[k][i] - next.poses[k][i]) < 0.1 * deg);
}

TEST_CASE("a ball in sockets, held by hand: a soft joint is named") {
  const Model arm = model_of(shipped("arm-panda/model.xml"));
  Program truth = program_of(
      with_elements(arm, R"xml(<joint_compliance at="joint4" compliance="0.02 deg/(N*m)"/>)xml"));
  draw_truth(truth, 4, 0.3);
  // Six places of the plate, both of its sockets.
  Recordings table;
  std::vector<double> location;
  Settings drawn = random_settings(truth, 300, 4);
  const std::vector<Coordinate> list = coordinates(truth);
  for (std::size_t k = 0; k < drawn.poses.size(); ++k) {
    const double place = static_cast<double>(k % 6);
    table.lines.push_back(static_cast<int>(k) + 2);
    location.push_back(place);
    for (std::size_t i = 0; i < list.size(); ++i) {
      double& v = drawn.poses[k][i];
      if (list[i].name == "plate_x") v = 400 + 40 * place;
      if (list[i].name == "plate_y") v = 150 * (place - 2.5);
      if (list[i].name == "plate_z") v = 100 + 60 * static_cast<double>(k % 3);
      if (list[i].name == "plate_azimuth") v = (20 + 25 * place) * deg;
      if (list[i].name == "hole") v = static_cast<double>(k / 6 % 2);
    }
  }
  add_column(table, "location", location);
  const Closed closed = close_loops(truth, drawn, {.table = &table, .noise = 1, .seed = 4});
  Recordings all = simulate(truth, closed.settings, {.seed = 4}), kept;
  kept.columns = all.columns;
  for (RecordedColumn& c : kept.columns) c.values.clear();
  for (std::size_t k = 0; k < all.rows(); ++k) {
    if (!closed.reached[k]) continue;
    kept.lines.push_back(all.lines[k]);
    for (std::size_t c = 0; c < all.columns.size(); ++c)
      kept.columns[c].values.push_back(all.columns[c].values[k]);
  }
  REQUIRE(kept.rows() > 60);
  const Diagnosed d = diagnosed(arm, kept);
  const Finding& soft = only(d, "joint_compliance@joint4");
  CHECK(std::abs(soft.accepted.amounts[0] / soft.accepted.std[0]) > 5);
  CHECK(!suspected(d, "probe_radius"));
}
