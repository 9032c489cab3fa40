// A linkage that is held at both ends: nothing drives its joints, the holder carries the rest.
#include "framework/kinematics/loads.h"
#include "tests/support/loads.h"

using namespace talus;
using namespace talus::testing;
using Eigen::Vector3d;

namespace {

constexpr double g = 9810;  // mm/s^2

}  // namespace

TEST_CASE("a body on three slides and a ball hangs on its holder alone") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="E">
      <mount name="x" x="s1"/><mount name="y" y="s2"/><mount name="z" z="s3"/>
      <spherical name="ball" roll="q1" pitch="q2" yaw="q3" mass="3 kg" com="10, 20, 30"/>
      <mount name="E" x="100"/></chain>
    <linear name="s1"/><linear name="s2"/><linear name="s3"/>
    <encoder name="q1"/><encoder name="q2"/><encoder name="q3"/>
    <gravity z="-1" held_at="E"/><point name="E" in="A"/></talus>)");
  Loads loads(program);
  loads.set(std::vector<double>{5, 6, 7, 0.3, 0.4, 0.5});
  CHECK((loads.reaction().force - Vector3d(0, 0, 3 * g)).norm() < 1e-8);
  const Vector3d from_E = loads.posture().frame(4).linear() * Vector3d(-90, 20, 30);
  CHECK((loads.reaction().moment + from_E.cross(Vector3d(0, 0, -3 * g))).norm() < 1e-6);
  for (int f = 1; f <= 4; ++f) {
    CHECK(loads.link(f).axis.force.norm() < 1e-8);
    CHECK(loads.link(f).axis.moment.norm() < 1e-6);
  }
  // Between the body and its holder.
  CHECK(loads.link(5).axis.force.norm() == doctest::Approx(3 * g));
}

TEST_CASE("the spatial linkage between its two clamps") {
  const Program program = program_of(shipped("isl-bonny-2013/published.xml"));
  REQUIRE(program.gravity->held_at == program.frame("E", {}));
  Program free = program_of(shipped("isl-bonny-2013/published.xml"));
  free.gravity->held_at = -1;
  Loads loads(program), unheld(free);
  const int E = program.frame("E", {});
  for (const auto& pose : random_settings(program, 20, 5).poses) {
    loads.set(pose);
    unheld.set(pose);
    // No torque about any axis, where a linkage that is not held has some.
    double torque = 0;
    for (int f = 1; f <= 6; ++f) {
      const int joint = program.frame("joint" + std::to_string(f), {});
      CHECK(std::abs(loads.link(joint).axis.moment.z()) < 1e-6);
      torque = std::max(torque, std::abs(unheld.link(joint).axis.moment.z()));
    }
    CHECK(torque > 1e5);  // 0.1 N m
    // What root and holder exert balances the weights: forces, and moments about the root.
    const int base = program.frame("base", {});
    const Wrench& root = loads.link(base).axis;
    Vector3d force = -root.force + loads.reaction().force,
             moment = -root.moment + loads.reaction().moment +
                      loads.posture().frame(E).translation().cross(loads.reaction().force);
    double total = 0;
    for (const Link& link : program.links) {
      const Vector3d weight = link.mass * g * eigen(program.gravity->direction);
      force += weight;
      moment += (loads.posture().frame(link.frame) * eigen(link.com)).cross(weight);
      total += link.mass;
    }
    CHECK(total == doctest::Approx(1.02));
    CHECK(force.norm() < 1e-6);
    CHECK(moment.norm() < 1e-4);
    // Energy: as one joint turns, the holder's work on E is what the weights rise by.
    for (std::size_t i = 0; i < pose.size(); ++i) {
      auto at = [&](const std::vector<double>& q) {
        Posture posture(program);
        posture.set(q);
        return posture;
      };
      const double rise = slope(
          pose, i, [&](const std::vector<double>& q) { return potential_energy(program, at(q)); });
      const Vector3d shift = slope(pose, i, [&](const std::vector<double>& q) {
        return Vector3d(at(q).frame(E).translation());
      });
      const Eigen::Matrix3d by = slope(pose, i, [&](const std::vector<double>& q) {
        return Eigen::Matrix3d(at(q).frame(E).linear());
      });
      const Eigen::Matrix3d turning = by * loads.posture().frame(E).linear().transpose();
      const Vector3d turn(turning(2, 1), turning(0, 2), turning(1, 0));
      const double work = loads.reaction().force.dot(shift) + loads.reaction().moment.dot(turn);
      CHECK(std::abs(work - rise) < 1e-6 * torque);
    }
  }
}

TEST_CASE("fewer joints than six, and singular postures: the smallest reaction, still no torque") {
  const Program program = program_from(R"(<talus>
    <chain from="A" to="E"><dh name="j1" theta="q1" a="300" mass="2 kg" com="-150, 0, 0"/>
      <dh name="j2" theta="q2" a="200" mass="1 kg" com="-100, 0, 0"/></chain>
    <encoder name="q1"/><encoder name="q2"/>
    <gravity y="-1" held_at="E"/><frame name="E" in="A"/></talus>)");
  Loads loads(program);
  for (const double q2 : {0.8, 0.0}) {  // bent; straight
    loads.set(std::vector<double>{0.3, q2});
    const double size = 3 * g * 500;
    CHECK(std::abs(loads.link(1).axis.moment.z()) < 1e-9 * size);
    CHECK(std::abs(loads.link(2).axis.moment.z()) < 1e-9 * size);
    // Nothing asks for a force across the plane, nor for a moment in it.
    CHECK(std::abs(loads.reaction().force.z()) < 1e-9 * size);
    CHECK(loads.reaction().moment.head<2>().norm() < 1e-9 * size);
    CHECK(loads.reaction().force.norm() < 3 * g);
  }
  loads.set(std::vector<double>{0.3, std::nan("")});
  CHECK(!loads.link(1).axis.moment.allFinite());
}
