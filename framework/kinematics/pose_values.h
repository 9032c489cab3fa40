// A rigid transform of expressions as numbers, pose after pose.
//
//     PoseValues T_B_E(program, program.between(B, E));
//     const PlainPose pose = T_B_E(slots_at(program, coordinates));
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/kinematics/tape_values.h"

namespace talus {

struct PlainPose {
  Matrix3<double> rotation;
  Vector3<double> translation;
};

class PoseValues {
 public:
  PoseValues(const Program& program, const Rigid<Expr>& transform);  // records on the tape
  PlainPose operator()(std::span<const double> slots);

 private:
  TapeValues values_;
};

// All slots' values: parameters at their nominal values, readings and then unknowns as given.
std::vector<double> slots_at(const Program& program, std::span<const double> coordinates);

// The slots through which a chain's end pose is read.
void set_chain(const Chain& chain, const PlainPose& pose, std::span<double> slots);

// Unit quaternion w, x, y, z with w >= 0.
std::array<double, 4> quaternion(const Matrix3<double>& rotation);

}  // namespace talus
