// Poses of closed linkages: drawn at random, moved until their loops close.
#include "framework/diagnosis/closed_loops.h"

#include "tests/support/models.h"

using namespace talus;
using namespace talus::testing;

namespace {

// How many of 50 random poses can be closed; that these are closed, and near where they were.
int closed(const Program& program, const char* in, const char* at, bool turn) {
  ClosedLoops loops(program);
  REQUIRE_FALSE(loops.none());
  Posture posture(program);
  const std::vector<Coordinate> list = coordinates(program);
  int count = 0;
  for (std::vector<double> pose : random_settings(program, 50, 7).poses) {
    if (!loops.close(pose, list, {})) continue;
    ++count;
    posture.set(pose);
    const Eigen::Isometry3d gap =
        posture.between(program.frame(in, Place{}), program.frame(at, Place{}));
    CHECK(gap.translation().norm() < 1e-5);
    if (turn) CHECK((gap.linear() - Eigen::Matrix3d::Identity()).norm() < 1e-8);
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!list[i].range) CHECK(pose[i] == list[i].rest);
      if (!list[i].range) continue;
      CHECK(pose[i] >= list[i].range->first);
      CHECK(pose[i] <= list[i].range->second);
    }
  }
  return count;
}

}  // namespace

TEST_CASE("a ball in a socket, seven joints") {
  const Program program = program_of(shipped("arm-panda/model.xml"));
  CHECK(ClosedLoops(program).names() == std::vector<std::string>{"contact"});
  CHECK(closed(program, "socket", "ball", false) > 20);
}

TEST_CASE("a four-bar linkage whose last frame meets the ground, turned as it") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="D"><dh name="crank" theta="q1" a="100"/><dh name="coupler" theta="q2" a="250"/>
      <dh name="rocker" theta="q3" a="200 ± 1"/><dh name="last" theta="q4" a="0"/></chain>
    <chain from="A" to="ground"><mount name="ground" x="220"/></chain>
    <encoder name="q1" range="-180, 180"/><encoder name="q2" range="-180, 180"/>
    <encoder name="q3" range="-180, 180"/><encoder name="q4" range="-360, 360"/>
    <closure name="loop" in="ground" at="D" sigma="0.1 mm, 0.1 deg"/></talus>)");
  CHECK(closed(program, "ground", "D", true) > 25);
}

TEST_CASE("an open linkage has no loops") {
  CHECK(ClosedLoops(program_of(shipped("arm-6r/model.xml"))).none());
}
