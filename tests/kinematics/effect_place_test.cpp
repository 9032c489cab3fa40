// Effects act on a joint's true axis, whatever way the joint is given, and the loads they depend on
// are those about the axis of the joint without effects.
#include <cmath>

#include "tests/support/diagnosed.h"

using namespace talus;
using namespace talus::testing;

namespace {

// A hinge about the axis through (10, 20, 30) that is z turned by -40 deg about x; the frame behind
// it coincides with the one before it at zero.
const char* as_matrix =
    R"(<revolute_about name="J" theta="q" x="10" y="20" z="30" uy="0.6427876096865393" uz="0.7660444431189780"/>)";
const char* as_turns = R"(<revolute name="J" theta="q" x="10" y="20" z="30" roll="-40"/>)";

Recordings poses(const std::string& joints, const std::string& effects) {
  const Program program = program_from(R"(<talus><chain from="A" to="E">
    <mount name="base" x="5" y="3" order="rpy" a="20" b="70" c="-40"/>)" +
                                       joints + R"(<mount name="E" x="200" y="100"/></chain>
    <encoder name="q" range="-170, 170"/><frame name="E" in="A"/>)" +
                                       effects + "</talus>");
  return recorded(program, 8, 3, 0);
}

double farthest(const Recordings& a, const Recordings& b) {
  double most = 0;
  for (const char* name : {"E.x", "E.y", "E.z"})
    for (std::size_t k = 0; k < a.rows(); ++k)
      most =
          std::max(most, std::abs(a.get(name, length).values[k] - b.get(name, length).values[k]));
  for (const char* name : {"E.qw", "E.qx", "E.qy", "E.qz"})
    for (std::size_t k = 0; k < a.rows(); ++k)
      most =
          std::max(most, std::abs(a.get(name, number).values[k] - b.get(name, number).values[k]));
  return most;
}

}  // namespace

TEST_CASE("an effect at a hinge given as a matrix acts on its true axis") {
  CHECK(farthest(poses(as_matrix, ""), poses(as_turns, "")) < 1e-10);
  for (const char* effect :
       {R"(<axis_tilt_wobble at="J" x_sine="0.5" y_cosine="0.3" order="2"/>)",
        R"(<axis_radial_runout at="J" x_sine="0.5" y_cosine="-0.2" order="2"/>)",
        R"(<axis_axial_runout at="J" sine="0.4" order="2"/>)"}) {
    CAPTURE(effect);
    CHECK(farthest(poses(as_matrix, effect), poses(as_turns, effect)) < 1e-9);
    CHECK(farthest(poses(as_matrix, effect), poses(as_matrix, "")) > 0.1);  // it does act
  }
}

TEST_CASE("a tiny error motion does not turn the axis about which a load acts") {
  const char* model = R"xml(<talus><chain from="A" to="E">
    <dh name="joint1" theta="e1" a="100" alpha="90"/>
    <dh name="joint2" theta="e2" a="200" mass="2 kg"/></chain>
    <encoder name="e1"/><encoder name="e2"/><gravity in="A" z="-1"/><frame name="E" in="A"/>
    <joint_compliance at="joint2" compliance="0.1 deg/(N*m)"/>{}</talus>)xml";
  auto with = [&](const std::string& effect) {
    std::string xml = model;
    return recorded(program_from(xml.replace(xml.find("{}"), 2, effect)), 8, 3, 0);
  };
  const Recordings plain = with("");
  CHECK(farthest(plain, with(R"(<axis_tilt_wobble at="joint2" x_sine="0.00001" order="2"/>)")) <
        1e-3);
}
