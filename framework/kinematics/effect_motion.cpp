#include "framework/kinematics/effect_motion.h"

namespace talus {

Rigid<Expr> motion_of(std::span<const Expr> twist) {
  auto none = [](const Expr& e) { return e.is_constant() && e.constant() == 0; };
  Rigid<Expr> result;
  auto add = [&](Motion<Expr>::Kind kind, int axis, const Expr& amount) {
    if (!none(amount)) result = result * Rigid<Expr>({kind, axis, amount});
  };
  for (int i = 0; i < 3; ++i) add(Motion<Expr>::Kind::translation, i, twist[i]);
  // The innermost turn is whole, those around it are halves on either side.
  std::vector<int> turns;
  for (int i = 0; i < 3; ++i)
    if (!none(twist[3 + i])) turns.push_back(i);
  const auto rotate = [&](int i, const Expr& angle) {
    add(Motion<Expr>::Kind::rotation, i, angle);
  };
  for (std::size_t t = 0; t < turns.size(); ++t)
    rotate(turns[t], t + 1 < turns.size() ? Expr(0.5) * twist[3 + turns[t]] : twist[3 + turns[t]]);
  for (std::size_t t = turns.size(); t-- > 1;)
    rotate(turns[t - 1], Expr(0.5) * twist[3 + turns[t - 1]]);
  return result;
}

}  // namespace talus
