// A rotation as three ordered rotations about coordinate axes, R = R_i(a) R_j(b) R_k(c), for any of
// the twelve sequences ijk: xyz, xzy, yxz, yzx, zxy, zyx, and xyx, xzx, yxy, yzy, zxz, zyz. Read
// from left to right each rotation is about an axis of the frame turned so far: "zxy" with flexion,
// internal rotation and inversion is R = Rz(phi1) Rx(phi3) Ry(phi2) of Nordquist and Hull 2009,
// eq. 4; "xzy" with roll, pitch and yaw is eq. 19 of Storey 2006.
//
// The angles come from arc tangents of two arguments, so none loses its quadrant:
//     i, j, k all different   a, c in (-180, 180] deg, b in [-90, 90] deg
//     k = i                   a, c in (-180, 180] deg, b in [0, 180] deg
// At the ends of b's range (the singular points) the first and the last rotation are about one
// line, and only their sum or difference is determined: there the last angle is 0 and the first
// holds all of it. Putting the angles back gives the same rotation everywhere.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "framework/model/error.h"

namespace talus {

struct AxisSequence {
  std::array<int, 3> axes;  // 0, 1, 2: x, y, z
};

// "zxy". InputError at `place` where it is not three axes, or where one follows on itself.
AxisSequence parse_axis_sequence(std::string_view text, const Place& place);

// Radians.
std::array<double, 3> angles_of(const Eigen::Matrix3d& rotation, const AxisSequence& sequence);
Eigen::Matrix3d rotation_of(const std::array<double, 3>& angles, const AxisSequence& sequence);

}  // namespace talus
