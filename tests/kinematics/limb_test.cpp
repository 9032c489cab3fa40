// Limbs in model files, and the twelve points of each.
#include "framework/kinematics/limb.h"

#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

const char* const xml = R"(<talus>
  <limb name="thigh" at="hip" length="60" width="4 cm" height="h" z="h/-2"/>
  <limb name="shank" length="30" width="20" height="10"/>
  <constant name="h" value="400 mm"/>
  <chain from="hip" to="shank">
    <dh name="knee" theta="q" a="100 ± 1"/>
    <mount name="shank" x="5"/>
  </chain>
  <encoder name="q"/>
  <point name="shank" in="hip"/>
</talus>)";

}  // namespace

TEST_CASE("limbs are read with their units, constants and frames") {
  const Program program = program_from(xml);
  REQUIRE(program.limbs.size() == 2);
  const Limb &thigh = program.limbs[0], &shank = program.limbs[1];
  CHECK(thigh.name == "thigh");
  CHECK(thigh.frame == program.frame("hip", {}));
  CHECK(thigh.size == Eigen::Vector3d(60, 40, 400));
  CHECK(thigh.centre == Eigen::Vector3d(0, 0, -200));
  CHECK(shank.frame == program.frame("shank", {}));
  CHECK(shank.centre == Eigen::Vector3d::Zero());
}

TEST_CASE("a limb in Lua is the same limb") {
  Registry registry = Registry::built_in();
  const Model lua = read_lua(R"(return talus {
    chain { from = "A", to = "B", dh { name = "j", theta = "q", a = "1 ± 1" } },
    encoder { name = "q" }, point { name = "B", ["in"] = "A" },
    limb { name = "B", length = 10, width = "2 cm", height = 30, x = 1 } })",
                             "model.lua", registry);
  const Program program = compile(lua, registry);
  REQUIRE(program.limbs.size() == 1);
  CHECK(program.limbs[0].size == Eigen::Vector3d(10, 20, 30));
  CHECK(program.limbs[0].centre == Eigen::Vector3d(1, 0, 0));
}

TEST_CASE("the twelve points: vertices, centre, ends of the local axes") {
  const Limb limb{"limb", 0, {1, 2, 3}, {20, 40, 60}, {}};
  LimbPoints expected;
  expected << -9, 11, 11, -9, -9, 11, 11, -9, 1, 11, 1, 1,  //
      -18, -18, 22, 22, -18, -18, 22, 22, 2, 2, 22, 2,      //
      -27, -27, -27, -27, 33, 33, 33, 33, 3, 3, 3, 33;
  CHECK(points(limb) == expected);
}

TEST_CASE("--set and calibrated models find the joint, not the limb of its name") {
  Registry registry = Registry::built_in();
  Model model = read_xml(xml, "model.xml", registry);
  CHECK(model.root.find_named("shank")->tag == "mount");
  CHECK(model.root.find_named("thigh")->tag == "limb");
}
