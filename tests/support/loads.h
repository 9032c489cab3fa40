// Loads by potential energy: what no balance of forces has a part in.
#pragma once

#include "framework/kinematics/loads.h"
#include "framework/kinematics/pose_values.h"
#include "tests/support/models.h"

namespace talus::testing {

inline Eigen::Vector3d eigen(const Vector3<double>& v) { return {v[0], v[1], v[2]}; }

// Minus the sum of m g . c over all links and payloads; kg mm^2/s^2.
inline double potential_energy(const Program& program, const Posture& posture,
                               const std::vector<double>& payloads = {}) {
  const Eigen::Vector3d g =
      program.gravity->magnitude *
      (posture.frame(program.gravity->frame).linear() * eigen(program.gravity->direction));
  double energy = 0;
  for (const Link& link : program.links)
    energy -= link.mass * g.dot(posture.frame(link.frame) * eigen(link.com));
  for (std::size_t i = 0; i < program.payloads.size(); ++i)
    energy -= (i < payloads.size() ? payloads[i] : program.payloads[i].mass) *
              g.dot(posture.frame(program.payloads[i].frame).translation());
  return energy;
}

// Its derivative by a coordinate, by the four-point difference: good to about 1e-10 of its size.
template <class F>
auto slope(std::vector<double> coordinates, std::size_t i, const F& f) {
  constexpr double h = 2e-3;
  auto at = [&](double by) {
    auto moved = coordinates;
    moved[i] += by;
    return f(moved);
  };
  using Value = decltype(f(coordinates));
  return Value((8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h));
}

inline Eigen::Isometry3d numbers(const Program& program, const Rigid<Expr>& transform,
                                 const std::vector<double>& slots) {
  const PlainPose pose = PoseValues(program, transform)(slots);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T(i, j) = pose.rotation[i][j];
    T(i, 3) = pose.translation[i];
  }
  return T;
}

}  // namespace talus::testing
