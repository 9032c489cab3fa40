// Where in a joint its own motion happens: the axis frame S between the frame A before the joint
// and the frame B behind it, T_A_B = T_A_S (moving) T_S_B.
//
// A joint is a product of elementary motions. S stands just before the first of them that depends
// on a coordinate (a reading, or an unknown of each pose), and its axes are exchanged in turn,
// where they have to be, so that z is the axis of that motion. For `dh` S is A itself; for
// `dh_proximal` it is behind Rx(alpha) Tx(a); for `revolute` behind Trans(p) Rx(roll) Ry(yaw). A
// motion given as a matrix (`revolute_about`) has its axis from its derivative, in the sense of a
// growing coordinate; S is then turned the shortest way from the coordinate axis that is nearest at
// the nominal values.
//
//     if (auto place = axis_place(program, motion))
//       motion = place->before * small_twist * place->moving * place->behind;
//
// The compiler notes it in each Frame, for the joint without its effects, which may depend on
// coordinates themselves.
#pragma once

#include <optional>

#include "framework/kinematics/program.h"

namespace talus {

struct AxisPlace {
  Rigid<Expr> before;  // T_A_S
  Rigid<Expr> moving;  // all motions from the first to the last that a coordinate moves, seen in S
  Rigid<Expr> behind;  // what remains: T_A_B = before * moving * behind
  bool turns = true;   // the motion turns about z of S; otherwise it slides along it
};

// Nothing where no coordinate moves the joint. `program` may still be in the making: it is asked
// for its readings, its unknowns and the parameters' nominal values.
std::optional<AxisPlace> axis_place(const Program& program, const Rigid<Expr>& motion);

// By slot: is it a coordinate? Unknowns that several poses share are placements, not coordinates.
std::vector<bool> coordinate_slots(const Program& program);

}  // namespace talus
