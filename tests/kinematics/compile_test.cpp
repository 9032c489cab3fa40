// What a compiled model is made of: parameters, frames, chains, rows.
#include <cmath>
#include <string>

#include "tests/support/fits.h"
#include "tests/support/plain.h"

using namespace talus;
using namespace talus::testing;

namespace {

double at(const Expr& e, const Program& program, const std::vector<double>& slots) {
  return e.is_constant() ? e.constant() : program.tape->evaluate(e.node(), slots);
}

Matrix4 numbers(const Rigid<Expr>& t, const Program& program, const std::vector<double>& slots) {
  Matrix4 m = trans(0, 0, 0);
  const std::vector<Expr> e = entries(t);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = at(e[3 * i + j], program, slots);
    m[i][3] = at(e[9 + i], program, slots);
  }
  return m;
}

// All slots at random, as for angles.
std::vector<double> random_values(const Program& program, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> slots;
  for (int i = 0; i < program.slots; ++i) slots.push_back(between(random, -1, 1));
  return slots;
}

}  // namespace

TEST_CASE("tied inputs are one parameter") {
  const Program program = program_from(R"(<talus>
    <parameter name="L" kind="length" value="120 ± 2"/>
    <chain from="B" to="E">
      <dh name="j1" theta="q1" a="L" d="5 ± 1"/>
      <dh name="j2" theta="q2" a="2*L" d="-j1.d"/>
    </chain>
    <encoder name="q1"/> <encoder name="q2"/>
    <point name="E" in="B"/>
  </talus>)");
  REQUIRE(program.parameters.size() == 2);
  CHECK(program.parameters[0].name == "j1.d");
  CHECK(program.parameters[1].name == "L");
  auto slots = random_values(program, 1);
  slots[program.parameters[0].slot] = 7, slots[program.parameters[1].slot] = 100;
  const double t1 = slots[program.readings[0].slot], t2 = slots[program.readings[1].slot];
  CHECK(farthest(numbers(program.chains[0].motions, program, slots),
                 rot_z(t1) * trans(100, 0, 7) * rot_z(t2) * trans(200, 0, -7)) < 1e-12);
}

TEST_CASE("coordinates may be expressions of several sensors") {
  const Program program = program_from(R"xml(<talus>
    <chain from="B" to="E">
      <dh name="j1" theta="-(q2 + q3)" a="10"/>
      <dh name="j2" theta="q2 + 90 deg" a="20"/>
      <dh name="j3" theta="q3/2"/>
    </chain>
    <encoder name="q2" slope="1 ± 0.1" intercept="3 ± 1"/> <encoder name="q3"/>
    <frame name="E" in="B"/>
  </talus>)xml");
  const auto slots = random_values(program, 2);
  const auto slot = [&](int i) { return slots[program.parameters[i].slot]; };
  REQUIRE(program.parameters[0].name == "q2.slope");
  const double q2 = slot(0) * slots[program.readings[0].slot] + slot(1),
               q3 = slots[program.readings[1].slot];
  CHECK(farthest(numbers(program.chains[0].motions, program, slots),
                 rot_z(-(q2 + q3)) * trans(10, 0, 0) * rot_z(q2 + 90 * deg) * trans(20, 0, 0) *
                     rot_z(q3 / 2)) < 1e-12);
}

TEST_CASE("between any two frames, across branches, T_a_b = T_root_a^-1 T_root_b") {
  const Program program = program_of(shipped("upper-body-justin/model.xml"));
  const auto slots = random_values(program, 3);
  const int frames = static_cast<int>(program.frames.size());
  std::vector<Matrix4> from_root;
  for (int f = 0; f < frames; ++f) {
    Matrix4 whole = trans(0, 0, 0);  // by hand, from the root down
    for (int g = f; g > 0; g = program.frames[g].parent)
      whole = numbers(program.frames[g].motion, program, slots) * whole;
    from_root.push_back(whole);
  }
  double worst = 0;
  for (int a = 0; a < frames; a += 3)
    for (int b = 0; b < frames; b += 2) {
      const Matrix4 T_a_b = numbers(program.between(a, b), program, slots);
      worst = std::max(worst, farthest(from_root[a] * T_a_b, from_root[b]));
    }
  CHECK(worst < 1e-9);
  // Nothing above the branching is gone through twice.
  const int left = program.frame("left_hand", {}), right = program.frame("right_hand", {});
  const Rigid<Expr> across = program.between(left, right);
  for (const Motion<Expr>& m : across.motions())
    for (int slot : support(m.amount)) CHECK(program.slot_names[slot].find("base.") != 0);
}

TEST_CASE("a chain's end is named by its last joint and by the chain") {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E"><dh name="joint1" theta="q"/><dh name="joint2" theta="q" a="80"/></chain>
    <encoder name="q"/>
    <point name="E"/>
  </talus>)");
  CHECK(program.frame("E", {}) == program.frame("joint2", {}));
  CHECK(program.frame("B", {}) == 0);
  CHECK(program.frames.size() == 3);
}

TEST_CASE("chains may stand in any order, and branch from any joint") {
  const Program program = program_from(R"(<talus>
    <chain from="wrist" to="tool"><mount name="flange" x="10"/></chain>
    <chain from="wrist" to="camera"><mount name="bracket" x="30"/></chain>
    <chain from="base" to="wrist"><mount name="column" z="100"/></chain>
    <chain from="column" to="lamp"><mount name="hook" y="1"/></chain>
    <point name="lamp" in="camera"/>
  </talus>)");
  CHECK(program.frames[0].name == "base");
  const auto slots = random_values(program, 1);
  CHECK(farthest(numbers(program.between(program.frame("camera", {}), program.frame("lamp", {})),
                         program, slots),
                 trans(-30, 1, 0)) < 1e-12);
}

TEST_CASE("every <calibrate> has inputs of its own") {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E"><dh name="j" theta="q" a="100"/></chain>
    <encoder name="q"/>
    <frame name="E" in="B"/>
    <closure name="c" in="B" at="E"/>
    <calibrate residual="frame_points" of="E" arm="100"/>
    <calibrate residual="frame_points" of="E" arm="3"/>
    <calibrate residual="distance" of="c" nominal="100 ± 1"/>
    <calibrate residual="distance" of="c" nominal="90 ± 1"/>
  </talus>)");
  REQUIRE(program.rows.size() == 26);
  CHECK(!program.rows[3].value.same(program.rows[15].value));
  REQUIRE(program.parameters.size() == 2);
  CHECK(program.parameters[0].name == "calibrate3.nominal");
  CHECK(program.parameters[1].name == "calibrate4.nominal");
  CHECK(program.parameters[1].nominal.value == 90);
}

TEST_CASE("without <calibrate> every feature has the residuals of its kind") {
  const Program program = program_from(R"(<talus>
    <chain from="B" to="E"><dh name="j" theta="q"/></chain>
    <encoder name="q"/>
    <frame name="E" in="B" sigma="0.1 mm, 0.2 deg"/>
    <point name="P" in="B" at="E" sigma="0.3"/>
    <length name="S" in="B" at="E"/>
  </talus>)");
  std::vector<std::string> names;
  for (const Row& row : program.rows) names.push_back(row.measure);
  CHECK(join(names) == "E.x, E.y, E.z, E.rx, E.ry, E.rz, P.x, P.y, P.z, S");
  CHECK(*program.rows[0].sigma == doctest::Approx(0.1));
  CHECK(*program.rows[3].sigma == doctest::Approx(0.2 * deg));
  CHECK(*program.rows[6].sigma == doctest::Approx(0.3));
  CHECK(!program.rows[9].sigma);
}

// A four-bar linkage: the loop is closed where coupler and rocker meet, and gives its angles.
TEST_CASE("a loop is closed by <closure>") {
  const Model model = [] {
    Registry registry = Registry::built_in();
    return read_xml(R"(<talus>
      <unknown name="u" kind="angle" value="-20"/>
      <unknown name="v" kind="angle" value="80"/>
      <chain from="ground" to="C">
        <dh name="crank" theta="q" a="40"/>
        <dh name="coupler" theta="u" a="120"/>
      </chain>
      <chain from="ground" to="D">
        <mount name="pivot" x="100 ± 5"/>
        <dh name="rocker" theta="v" a="80"/>
      </chain>
      <encoder name="q"/>
      <closure name="joint" in="D" at="C" sigma="0.01"/>
      <point name="tip" in="ground" at="coupler" sigma="0.01"/>
      <calibrate residual="position" of="joint, tip"/>
    </talus>)",
                    "four-bar.xml", registry);
  }();
  const Program program = program_of(model);
  REQUIRE(program.rows.size() == 6);
  // By hand: crank, then the two circles' intersection; the ground is 103 long.
  Recordings recordings;
  recordings.columns = {{"q", *parse_unit("deg"), {}, {}},
                        {"tip.x", *parse_unit("mm"), {}, {}},
                        {"tip.y", *parse_unit("mm"), {}, {}},
                        {"tip.z", *parse_unit("mm"), {}, {}}};
  for (int k = 0; k < 40; ++k) {
    const double q = (20 + 2 * k) * deg, ground = 103;
    const double ax = 40 * std::cos(q), ay = 40 * std::sin(q), dx = ground - ax, dy = -ay;
    const double d = std::hypot(dx, dy), along = (120 * 120 - 80 * 80 + d * d) / (2 * d),
                 across = std::sqrt(120 * 120 - along * along);
    const double values[] = {q, ax + (along * dx - across * dy) / d,
                             ay + (along * dy + across * dx) / d, 0};
    for (int c = 0; c < 4; ++c) recordings.columns[c].values.push_back(values[c]);
    recordings.lines.push_back(k + 2);
  }
  const Fit fit = calibrate(program, recordings, all_to_fit(recordings), {.restarts = 0});
  CHECK(fit.converged);
  CHECK(fit.chi2 < 1e-6);
  CHECK(value(fit, "pivot.x").value == doctest::Approx(103).epsilon(1e-7));
}
