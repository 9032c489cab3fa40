// Limbs: the bodies that a linkage's frames carry, as cuboids (Storey et al. 2006, sec. II). They
// take no part in any calculation of motion; pictures show them and tables of motion list their
// points.
//
//     <limb name="shank" at="knee" length="60" width="40" height="380" z="-190"/>
//
// A limb's local origin is its geometric centre, its axes are parallel to those of its frame;
// length, width and height are its edges along x, y and z.
#pragma once

#include <Eigen/Core>
#include <string>

#include "framework/model/error.h"

namespace talus {

struct Limb {
  std::string name;
  int frame = 0;           // index in Program::frames
  Eigen::Vector3d centre;  // in that frame, mm
  Eigen::Vector3d size;    // length, width, height, mm
  Place place;
};

// Twelve points in the limb's frame, a column each, in Storey's order: eight vertices, the centre,
// the ends of the local axes. The paper leaves two things open. Vertices here: the face at the
// lower z, then that at the upper z, each from (-x, -y) by way of +x, (+x, +y) and (-x, +y). The
// ends of the axes lie in the middles of the faces at +x, +y and +z, half an edge from the centre.
using LimbPoints = Eigen::Matrix<double, 3, 12>;
LimbPoints points(const Limb& limb);

}  // namespace talus
