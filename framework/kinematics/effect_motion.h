// The small motion that an effect inserts into a chain: a translation, then a rotation by a vector,
// as elementary motions so that the solver sees each one's own axis. The rotation is the symmetric
// product Rx/2 Ry/2 Rz Ry/2 Rx/2, equal to the exponential up to the third order of the angle.
#pragma once

#include <span>

#include "framework/kinematics/rigid.h"

namespace talus {

// `twist`: translation, rotation; its z axis is axis `z` of the frame (0, 1, 2), x and y follow in
// cyclic order. Parts that are the constant zero are left out.
Rigid<Expr> motion_of(std::span<const Expr> twist, int z = 2);

// Where a joint moves: its motions [first, last) are those that depend on any of the slots; `z` is
// the axis of the first of them (2 where it is a matrix). first == last: it does not move.
struct MovingPart {
  std::size_t first = 0, last = 0;
  int z = 2;
};
MovingPart moving_part(const Rigid<Expr>& motions, std::span<const int> slots);

}  // namespace talus
