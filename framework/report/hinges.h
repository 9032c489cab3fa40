// The hinges of a serial chain, found from what its joints do rather than from their types: lines
// about which one coordinate each turns everything behind.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "framework/kinematics/dh_chain.h"
#include "framework/kinematics/program.h"
#include "framework/model/model.h"

namespace talus {

// A joint that turns.
struct ChainHinge {
  int frame;               // the frame behind it
  const Element* element;  // of the model
  std::string coordinate;  // its text: "encoder1", "-(q2 + q3)"
  AxisLine line;           // at the reference posture, directed in the sense of the coordinate
  double turn = 0;         // the coordinate's value there, modulo a turn
};

struct HingeChain {
  std::vector<ChainHinge> hinges;                // in order
  std::vector<int> body;                         // of each frame: how many hinges move it
  std::vector<Eigen::Isometry3d> frames;         // at the reference posture, in the root
  std::map<std::string, const Element*> joints;  // all, by the name of the frame behind them
};

// At readings of zero and unknowns at their start, or where that is outside a sensor's domain at
// some other posture. InputError where the chain branches, or a joint does anything but turn about
// one axis by its one coordinate. `program` is compiled from `model`, which must stay while this is
// used.
HingeChain hinge_chain(const Model& model, const Registry& registry, const Program& program);

// Largest difference between the entries of two poses (mm and, about, rad); huge for NaN.
double farthest(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

}  // namespace talus
