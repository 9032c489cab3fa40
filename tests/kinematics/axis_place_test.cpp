// The axis frame of every joint: on the joint's axis, and the two halves make the joint.
#include "framework/kinematics/axis_place.h"

#include <sstream>

#include "tests/support/loads.h"

using namespace talus;
using namespace talus::testing;

namespace {

// <joint name="J" .../> behind a frame that lies askew, at a coordinate of 0.4.
void check(const std::string& joint, bool turns = true) {
  CAPTURE(joint);
  const Program program = program_from(R"(<talus><chain from="A" to="J">
    <mount name="base" x="5" y="3" a="20" b="70" c="-40"/>)" +
                                       joint + R"(</chain>
    <encoder name="q" slope="2"/><linear name="s"/><point name="J" in="A"/></talus>)");
  const auto& motion = program.frames.back().motion;
  const auto place = axis_place(program, motion);
  REQUIRE(place);
  CHECK(place->turns == turns);
  Posture posture(program);
  for (const double q : {0.0, 0.4, -1.3}) {
    const std::vector<double> coordinates(program.readings.size(), q);
    posture.set(coordinates);
    const auto slots = slots_at(program, coordinates);
    const Eigen::Isometry3d T_A_S = numbers(program, place->before, slots),
                            T_S_B = numbers(program, place->moving * place->behind, slots),
                            T_A_B = numbers(program, motion, slots);
    CHECK(((T_A_S * T_S_B).matrix() - T_A_B.matrix()).norm() < 1e-12);
    CHECK((T_A_S.linear() * T_A_S.linear().transpose() - Eigen::Matrix3d::Identity()).norm() <
          1e-12);
    CHECK(T_A_S.linear().determinant() == doctest::Approx(1));
    const Eigen::Isometry3d S = posture.frame(program.frames.back().parent) * T_A_S;
    REQUIRE(posture.axes().size() >= 1);
    const JointAxis& axis = posture.axes().front();
    CHECK((S.linear().col(2) - axis.direction).norm() < 1e-12);
    if (turns) CHECK((S.translation() - axis.point).cross(axis.direction).norm() < 1e-10);
  }
}

}  // namespace

TEST_CASE("the axis frame has its z on the joint's axis and its halves make the joint") {
  check(R"(<dh name="J" theta="q" d="10" a="20" alpha="30"/>)");
  check(R"(<dh_proximal name="J" theta="q" d="10" a="20" alpha="30"/>)");
  check(R"(<revolute name="J" theta="q" x="1" y="2" z="3" roll="40" yaw="50"/>)");
  check(R"(<screw name="J" theta="q" pitch="3" x="1" y="2" z="3" roll="40" yaw="50"/>)");
  check(R"(<storey name="J" theta="q" x_fp="1" y_fp="2" psi_fp="30" phi_fp="-20" x_td="9"/>)");
  check(R"(<prismatic name="J" d="s" roll="40" yaw="50"/>)", false);
  check(R"(<mount name="J" order="rpy" y="7" a="q" z="3"/>)");
  check(R"(<mount name="J" order="rpy" y="7" c="20" b="q" a="10"/>)");
  check(R"(<mount name="J" x="s" y="7" a="20"/>)", false);
  // Matrices: the axis near each of the coordinate axes, both ways.
  for (const char* u : {"1 0.3 -0.2", "-1 0.3 0.5", "0.2 1 0.1", "0.2 -1 0.6", "0.1 0.2 2",
                        "0.1 0.2 -2", "0 0 -1", "0 -3 0"}) {
    std::istringstream words(u);
    std::string x, y, z;
    words >> x >> y >> z;
    check(R"(<revolute_about name="J" theta="q" x="1" y="2" z="3" ux=")" + x + R"(" uy=")" + y +
          R"(" uz=")" + z + R"("/>)");
  }
}

TEST_CASE("a joint whose axis is z already needs no turn; one that nothing moves has no axis") {
  const Program program = program_from(R"(<talus><chain from="A" to="E">
    <dh name="dh" theta="q + 90 deg" d="10" a="20 ± 1" alpha="30"/>
    <dh_proximal name="still" theta="0 ± 1" a="5" alpha="90"/>
    <mount name="E" x="1 ± 1"/></chain>
    <encoder name="q"/><frame name="E" in="A"/></talus>)");
  const auto place = axis_place(program, program.frames[1].motion);
  REQUIRE(place);
  CHECK(place->before.motions().empty());
  CHECK(place->moving.motions().size() == 1);
  CHECK(place->behind.motions().size() == 3);
  CHECK(!axis_place(program, program.frames[2].motion));
  CHECK(!axis_place(program, program.frames[3].motion));
}

TEST_CASE("an unknown shared by several poses is a placement, one of each pose a coordinate") {
  const char* xml = R"(<talus><unknown name="u" kind="angle"{}/>
    <chain from="A" to="E"><dh name="J" theta="u" a="5"/><dh name="E" theta="q" a="7"/></chain>
    <encoder name="q"/><point name="E" in="A"/></talus>)";
  auto with = [&](const std::string& per) {
    std::string text = xml;
    const Program program = program_from(text.replace(text.find("{}"), 2, per));
    return axis_place(program, program.frames[1].motion).has_value();
  };
  CHECK(with(""));
  CHECK(!with(R"( per="session")"));
}
