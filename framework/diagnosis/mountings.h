// Other mountings: the linkage turned with the frame it is measured in, so that its weights pull
// another way. What poses alone cannot tell from a joint's own errors may show then.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"

namespace talus {

struct Mounting {
  Eigen::Vector3d down;  // gravity's direction, in the frame of <gravity>
  std::string words;     // "B turned 90 deg about its x axis"
};

// A quarter turn about each axis, either way, and half a turn; those that leave gravity where it
// was, or where an earlier one puts it, are left out. None where no weight is felt, or where the
// frame of gravity does not stand still in the root: turned, it would have to be located anew.
std::vector<Mounting> mountings(const Program& program);

}  // namespace talus
