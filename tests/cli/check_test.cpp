// talus check: what it tells of a linkage's joint axes.
#include "tests/support/command.h"
#include "tests/support/models.h"

using namespace talus::testing;

TEST_CASE("check prints angle and distance between the axes of consecutive joints") {
  const Folder folder;
  auto axes = [&](const std::string& model) {
    const Run run = command(folder, "check " + model);
    CAPTURE(run.error);
    REQUIRE(run.code == 0);
    const std::size_t at = run.out.find("Joint axes, readings at zero\n");
    return at == std::string::npos ? "" : run.out.substr(at);
  };
  CHECK(axes("'" + shipped("ankle-storey-2006/model.xml") + "'") ==
        "Joint axes, readings at zero\n"
        "  joints                 angle, deg  distance, mm\n"
        "  talocrural - subtalar       63.26         9.367\n");
  // Parallel axes are apart by no rounding error; a tree is followed along its branches; two
  // coordinates of one joint are one axis; units are the model's.
  folder.write("tree.xml", R"(<talus length="m" angle="rad">
    <chain from="B" to="E"><dh name="a" theta="q1 + q2" a="0.5" alpha="180 deg"/>
      <fixed name="plate" z="3"/><dh name="b" theta="q2" a="0.1"/></chain>
    <chain from="plate" to="F"><revolute_about name="c" theta="q1" ux="1" uz="0" y="0.25"/></chain>
    <encoder name="q1"/><encoder name="q2"/>
    <point name="E" in="B"/><point name="F" in="B"/></talus>)");
  CHECK(axes("tree.xml") ==
        "Joint axes, readings at zero\n"
        "  joints  angle, rad  distance, m\n"
        "  a - b        0             0.5\n"
        "  a - c        1.571         0.25\n");
  folder.write("one.xml", R"(<talus><chain from="B" to="E"><dh name="a" theta="q1"/></chain>
    <encoder name="q1"/><frame name="E" in="B"/></talus>)");
  CHECK(axes("one.xml") == "");
}
