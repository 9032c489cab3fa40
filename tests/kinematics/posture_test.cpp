#include "framework/kinematics/posture.h"

#include <doctest/doctest.h>

#include "tests/support/models.h"

using namespace talus;

TEST_CASE("frames and axes of a linkage at a posture") {
  const Program program = testing::program_from(R"(<talus>
    <chain from="A" to="C">
      <dh name="elbow" theta="q1" d="10" a="100" alpha="90"/>
      <revolute_about name="wrist" theta="q2" x="5" y="0" z="0" ux="0" uy="2" uz="0"/>
      <prismatic name="slide" d="s"/>
    </chain>
    <encoder name="q1" slope="2"/><encoder name="q2"/><linear name="s"/>
    <point name="C" in="A"/></talus>)");
  Posture posture(program);
  posture.set(std::vector<double>{45 * deg, 0, 7});
  const int C = program.frame("C", {});
  // q1 = 90 deg: along y by 100, up by 10; alpha turns z of the next frame to x of A.
  CHECK((posture.frame(C).translation() - Eigen::Vector3d(7, 100, 10)).norm() < 1e-12);
  CHECK((posture.between(C, 0) * posture.frame(C).translation()).norm() < 1e-12);
  REQUIRE(posture.axes().size() == 3);
  const JointAxis &elbow = posture.axes()[0], &wrist = posture.axes()[1],
                  &slide = posture.axes()[2];
  CHECK(elbow.joint == "elbow");
  CHECK((elbow.direction - Eigen::Vector3d::UnitZ()).norm() < 1e-12);
  CHECK(elbow.point.head<2>().norm() < 1e-12);
  CHECK((wrist.direction - Eigen::Vector3d::UnitZ()).norm() < 1e-12);
  CHECK((wrist.point.head<2>() - Eigen::Vector2d(0, 105)).norm() < 1e-12);
  CHECK(!slide.turns);
  CHECK((slide.direction - Eigen::Vector3d::UnitX()).norm() < 1e-12);
  CHECK(apart(elbow, wrist).distance == doctest::Approx(105));
  CHECK(apart(elbow, wrist).angle == doctest::Approx(0));
  CHECK(apart(elbow, slide).angle == doctest::Approx(90 * deg));
}
