#include "framework/kinematics/axis_place.h"

#include <cmath>

namespace talus {
namespace {

using Moves = Motion<Expr>::Kind;

// The first coordinate that moves it, or -1.
int coordinate_of(const Motion<Expr>& motion, const std::vector<bool>& coordinate) {
  std::vector<Expr> parts{motion.amount};
  if (motion.kind == Moves::matrix) {
    parts.assign(motion.translation.begin(), motion.translation.end());
    for (const auto& row : motion.rotation) parts.insert(parts.end(), row.begin(), row.end());
  }
  int first = -1;
  for (const Expr& part : parts)
    for (const int slot : support(part))
      if (coordinate[slot] && (first < 0 || slot < first)) first = slot;
  return first;
}

// A turn that makes z what was axis `k`, and x, y what follow it.
Rigid<Expr> exchanged(int k) {
  if (k == 2) return {};
  Matrix3<Expr> R{};
  for (int j = 0; j < 3; ++j) R[(k + 1 + j) % 3][j] = Expr(1);
  return {R, {}};
}

Expr derivative(const Expr& e, int slot) {
  const auto by = gradient(e);
  const auto it = by.find(slot);
  return it == by.end() ? Expr(0) : it->second;
}

double nominal(const Program& program, const Expr& e) {
  if (e.is_constant()) return e.constant();
  std::vector<double> slots(program.slots, 0);
  for (const Parameter& p : program.parameters) slots[p.slot] = p.nominal.value;
  return e.tape()->evaluate(e.node(), slots);
}

// From the frame before a motion given as a matrix to one on its axis: dR R^T = [w], the axis goes
// through w x v / w^2 with v = dp - w x p.
Rigid<Expr> onto_axis(const Program& program, const Motion<Expr>& motion, int slot, bool& turns) {
  const Matrix3<Expr>& R = motion.rotation;
  Matrix3<Expr> turn{};
  Vector3<Expr> by;
  for (int i = 0; i < 3; ++i) {
    by[i] = derivative(motion.translation[i], slot);
    for (int k = 0; k < 3; ++k) {
      const Expr d = derivative(R[i][k], slot);
      for (int j = 0; j < 3; ++j) turn[i][j] += d * R[j][k];
    }
  }
  const Vector3<Expr> w{turn[2][1], turn[0][2], turn[1][0]};
  const Vector3<Expr> v = by - cross(w, motion.translation);
  auto size = [&](const Vector3<Expr>& a) { return nominal(program, dot(a, a)); };
  turns = !(size(w) < 1e-18);
  Vector3<Expr> u = turns ? w : v;
  const Expr square = dot(u, u);
  Rigid<Expr> S;
  if (turns) {
    const Vector3<Expr> foot = cross(w, v);
    S = translate(foot[0] / square, foot[1] / square, foot[2] / square);
  }
  int k = 0;
  for (Expr& each : u) each = each / sqrt(square);
  for (int i = 1; i < 3; ++i)
    if (std::abs(nominal(program, u[i])) > std::abs(nominal(program, u[k]))) k = i;
  S = S * exchanged(k);
  if (nominal(program, u[k]) < 0) {  // half a turn about x
    Matrix3<Expr> half{};
    for (int j = 0; j < 3; ++j) half[j][j] = Expr(j == 0 ? 1 : -1);
    S = S * Rigid<Expr>(half, {});
  }
  const Vector3<Expr> z = seen_from(S.rotation(), u);
  const Expr c = Expr(1) / (Expr(1) + z[2]);
  return S * Rigid<Expr>({{{Expr(1) - c * z[0] * z[0], -(c * z[0] * z[1]), z[0]},
                           {-(c * z[0] * z[1]), Expr(1) - c * z[1] * z[1], z[1]},
                           {-z[0], -z[1], z[2]}}},
                         {});
}

}  // namespace

std::vector<bool> coordinate_slots(const Program& program) {
  std::vector<bool> result(program.slots);
  for (const Reading& r : program.readings) result[r.slot] = !r.covariate;
  for (const Unknown& u : program.unknowns) result[u.slot] = u.per.empty();
  return result;
}

std::optional<AxisPlace> axis_place(const Program& program, const Rigid<Expr>& motion) {
  const std::vector<bool> coordinate = coordinate_slots(program);
  const auto& motions = motion.motions();
  auto slot_of = [&](std::size_t i) { return coordinate_of(motions[i], coordinate); };
  std::size_t first = 0, last = motions.size();
  while (first < last && slot_of(first) < 0) ++first;
  if (first == last) return {};
  while (slot_of(last - 1) < 0) --last;
  const Motion<Expr>& own = motions[first];
  AxisPlace place;
  place.turns = own.kind == Moves::rotation;
  const Rigid<Expr> S = own.kind == Moves::matrix
                            ? onto_axis(program, own, slot_of(first), place.turns)
                            : exchanged(own.axis);
  for (std::size_t i = 0; i < first; ++i) place.before = place.before * Rigid<Expr>(motions[i]);
  place.before = place.before * S;
  if (last - first == 1 && own.kind != Moves::matrix) {
    place.moving = Rigid<Expr>({own.kind, 2, own.amount});
  } else {
    place.moving = inverse(S);
    for (std::size_t i = first; i < last; ++i)
      place.moving = place.moving * Rigid<Expr>(motions[i]);
    place.moving = place.moving * S;
  }
  place.behind = inverse(S);
  for (std::size_t i = last; i < motions.size(); ++i)
    place.behind = place.behind * Rigid<Expr>(motions[i]);
  return place;
}

}  // namespace talus
