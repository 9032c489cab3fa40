#include "framework/kinematics/effect_motion.h"

#include <algorithm>

namespace talus {

Rigid<Expr> motion_of(std::span<const Expr> twist, int z) {
  auto none = [](const Expr& e) { return e.is_constant() && e.constant() == 0; };
  Rigid<Expr> result;
  auto add = [&](Motion<Expr>::Kind kind, int axis, const Expr& amount) {
    if (!none(amount)) result = result * Rigid<Expr>({kind, (axis + z + 1) % 3, amount});
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

MovingPart moving_part(const Rigid<Expr>& motions, std::span<const int> slots) {
  auto depends = [&](const Expr& e) {
    const std::vector<int> on = support(e);
    return std::any_of(slots.begin(), slots.end(),
                       [&](int s) { return std::binary_search(on.begin(), on.end(), s); });
  };
  auto moves = [&](const Motion<Expr>& m) {
    if (m.kind != Motion<Expr>::Kind::matrix) return depends(m.amount);
    for (int i = 0; i < 3; ++i) {
      if (depends(m.translation[i])) return true;
      for (int j = 0; j < 3; ++j)
        if (depends(m.rotation[i][j])) return true;
    }
    return false;
  };
  MovingPart part;
  const auto& all = motions.motions();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (moves(all[i])) {
      if (part.last == 0) {
        part.first = i;
        part.z = all[i].kind == Motion<Expr>::Kind::matrix ? 2 : all[i].axis;
      }
      part.last = i + 1;
    }
  return part;
}

}  // namespace talus
