// Static loads against closed forms, against the potential energy, and against the balance of a
// linkage that is held at both ends.
#include "framework/kinematics/loads.h"

#include "tests/support/loads.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Vector3d;

namespace {

constexpr double g = 9810;  // mm/s^2

bool near(const Vector3d& a, const Vector3d& b, double size) {
  return (a - b).norm() < 1e-9 * size;
}

// A placement rather than a coordinate.
bool shared(const Program& program, int coordinate) {
  const int unknown = coordinate - static_cast<int>(program.readings.size());
  return unknown >= 0 && !program.unknowns[unknown].per.empty();
}

// The torque that each coordinate feels, from the loads in the axis frames: those along z of S, or,
// where a joint has several coordinates, about and along the axis of each.
std::vector<double> torques(const Program& program, const Loads& loads,
                            const std::vector<double>& coordinates) {
  const auto slots = slots_at(program, coordinates);
  std::map<int, int> axes_of;
  for (const JointAxis& axis : loads.posture().axes()) ++axes_of[axis.frame];
  std::vector<double> result(coordinates.size(), 0);
  for (const JointAxis& axis : loads.posture().axes()) {
    if (shared(program, axis.coordinate)) continue;
    const Frame& frame = program.frames[axis.frame];
    const auto place = axis_place(program, frame.motion);
    REQUIRE(place);
    const Eigen::Isometry3d S =
        loads.posture().frame(frame.parent) * numbers(program, place->before, slots);
    const Wrench& load = loads.link(axis.frame).axis;
    if (axes_of[axis.frame] > 1) {
      result[axis.coordinate] += axis.turn().dot(S.linear() * load.moment) +
                                 axis.shift(S.translation()).dot(S.linear() * load.force);
      continue;
    }
    const double sense = S.linear().col(2).dot(axis.direction);
    CHECK(std::abs(std::abs(sense) - 1) < 1e-12);
    result[axis.coordinate] +=
        sense * axis.rate *
        (axis.turns ? load.moment.z() + axis.pitch * load.force.z() : load.force.z());
  }
  return result;
}

// At random postures, the torque of every coordinate is minus the slope of the potential energy.
void check_energy(Program program, const std::vector<double>& payloads = {}) {
  program.gravity->held_at = -1;
  Loads loads(program);
  for (const auto& pose : random_settings(program, 10, 3).poses) {
    loads.set(pose, {}, payloads);
    const auto torque = torques(program, loads, pose);
    double largest = 0;
    for (const double t : torque) largest = std::max(largest, std::abs(t));
    CHECK(largest > 0);
    for (std::size_t i = 0; i < pose.size(); ++i) {
      if (shared(program, static_cast<int>(i))) continue;
      const double expected = -slope(pose, i, [&](const std::vector<double>& q) {
        Posture posture(program);
        posture.set(q);
        return potential_energy(program, posture, payloads);
      });
      CAPTURE(i);
      CHECK(std::abs(torque[i] - expected) < 1e-8 * largest);
    }
  }
}

}  // namespace

TEST_CASE("a pendulum by hand") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="B"><dh name="j" theta="q" a="300" mass="2 kg" com="-100, 0, 5"/></chain>
    <encoder name="q"/><gravity y="-3"/><point name="B" in="A"/></talus>)");
  Loads loads(program);
  for (const double q : {0.0, 0.7, -2.0}) {
    loads.set(std::vector<double>{q});
    const LinkLoad& load = loads.link(1);
    const double c = std::cos(q), s = std::sin(q);
    CHECK(near(load.axis.force, {0, -2 * g, 0}, g));
    CHECK(near(load.axis.moment, {5 * 2 * g, 0, -200 * c * 2 * g}, 1000 * g));
    CHECK(near(load.weight, {-s * 2 * g, -c * 2 * g, 0}, g));
    CHECK(near(load.span, {300, 0, 0}, 300));
    CHECK(load.tip.force == Vector3d::Zero());
    CHECK(load.tip.moment == Vector3d::Zero());
  }
}

TEST_CASE("an arm of two links and a payload by hand") {
  const Program program = program_from(R"(<talus length="m">
    <chain from="A" to="B">
      <dh name="upper" theta="q1" a="0.3" mass="2 kg" com="-0.15, 0, 0"/>
      <dh name="fore" theta="q2" a="0.2" mass="1000 g" com="-0.1, 0, 0"/></chain>
    <encoder name="q1"/><encoder name="q2"/>
    <gravity in="A" y="-1" magnitude="1.62"/><payload at="B" mass="0.5 kg"/>
    <point name="B" in="A"/></talus>)");
  Loads loads(program);
  const double moon = 1620, q1 = 0.4, q2 = -1.1, c1 = std::cos(q1), c12 = std::cos(q1 + q2),
               s12 = std::sin(q1 + q2);
  loads.set(std::vector<double>{q1, q2});
  const double fore = -moon * (1 * 100 * c12 + 0.5 * 200 * c12),
               upper = fore - moon * (2 * 150 * c1 + 1.5 * 300 * c1);
  const LinkLoad &first = loads.link(1), &second = loads.link(2);
  CHECK(near(first.axis.moment, {0, 0, upper}, std::abs(upper)));
  CHECK(near(first.axis.force, {0, -3.5 * moon, 0}, moon));
  CHECK(near(second.axis.moment, {0, 0, fore}, std::abs(upper)));
  // At the elbow, in the upper arm's own frame: the forearm and the payload, not the upper arm.
  CHECK(near(first.tip.force, 1.5 * moon * Vector3d(-std::sin(q1), -c1, 0), moon));
  CHECK(near(first.tip.moment, {0, 0, fore}, std::abs(upper)));
  CHECK(near(second.axis.force, first.tip.force, moon));
  CHECK(near(second.tip.force, 0.5 * moon * Vector3d(-s12, -c12, 0), moon));
  CHECK(near(second.tip.moment, Vector3d::Zero(), 1));
  CHECK(near(second.weight, moon * Vector3d(-s12, -c12, 0), moon));
  CHECK(near(second.span, {200, 0, 0}, 200));
  CHECK(near(second.own_moment, {0, 0, 100 * moon * c12}, moon));
  // Three times the payload.
  loads.set(std::vector<double>{q1, q2}, {}, std::vector<double>{1.5});
  CHECK(loads.link(2).axis.moment.z() == doctest::Approx(-moon * (100 + 1.5 * 200) * c12));
}

TEST_CASE("the axis frame of a joint about x: z along it") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="B"><mount name="B" order="rpy" y="50" a="q" mass="1 kg" com="0, 100, 0"/></chain>
    <encoder name="q"/><gravity z="-1"/><point name="B" in="A" x="1"/></talus>)");
  Loads loads(program);
  loads.set(std::vector<double>{0.3});
  CHECK(near(loads.link(1).axis.moment, {0, 0, -100 * std::cos(0.3) * g}, 100 * g));
  CHECK(near(loads.link(1).axis.force, {0, -g, 0}, g));  // x, y of S are y, z of A
}

TEST_CASE("torques are minus the slopes of the potential energy") {
  check_energy(program_of(shipped("arm-6r/model.xml")), {4.5});
  check_energy(program_of(shipped("arm-panda/model.xml")));
  check_energy(program_of(shipped("isl-bonny-2013/published.xml")));
  // A tree: both arms load the torso; one angle is minus the sum of two others.
  check_energy(program_of(shipped("upper-body-justin/model.xml")));
  // A screw, a slide, a ball, an axis given by a vector.
  check_energy(program_from(R"(<talus>
    <chain from="A" to="B">
      <screw name="j1" theta="q1" pitch="30" x="10" y="40" z="3" roll="40" yaw="50" mass="1 kg" com="40, 90, 5"/>
      <prismatic name="j2" d="s" roll="30" yaw="-20" mass="2 kg" com="4, -9, 50"/>
      <spherical name="j3" roll="q2" pitch="q3" yaw="q4" x="20"/>
      <revolute_about name="j4" theta="q5" x="20" ux="-0.4" uy="1" uz="-3" mass="0.4 kg" com="70, 0, 40"/>
    </chain>
    <encoder name="q1" slope="-2"/><encoder name="q2"/><encoder name="q3" slope="0.3"/><encoder name="q4"/>
    <encoder name="q5"/><linear name="s" slope="0.5"/>
    <gravity in="A" x="0.1" y="0.4" z="-1"/><point name="B" in="A"/></talus>)"));
}
