// The small motion that an effect inserts into a chain: a translation, then a rotation by a vector,
// as elementary motions so that the solver sees each one's own axis. The rotation is the symmetric
// product Rx/2 Ry/2 Rz Ry/2 Rx/2, equal to the exponential up to the third order of the angle.
#pragma once

#include <span>

#include "framework/kinematics/rigid.h"

namespace talus {

// `twist`: translation, rotation. Parts that are the constant zero are left out.
Rigid<Expr> motion_of(std::span<const Expr> twist);

}  // namespace talus
