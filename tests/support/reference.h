// An independent reference for derivatives: the nodes of a tape evaluated in long double, and a
// central difference of sixth order,
//     f' = (45 (f1 - f-1) - 9 (f2 - f-2) + (f3 - f-3)) / (60 h) + O(h^6).
// It shares no code with the symbolic gradient or with the solver's evaluators.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "framework/kinematics/expr.h"

namespace talus::reference {

using Real = long double;

inline Real apply(Op op, Real a, Real b, Real c) {
  switch (op) {
    case Op::constant:
    case Op::leaf:
      return a;
    case Op::add:
      return a + b;
    case Op::sub:
      return a - b;
    case Op::mul:
      return a * b;
    case Op::div:
      return a / b;
    case Op::neg:
      return -a;
    case Op::sin:
      return std::sin(a);
    case Op::cos:
      return std::cos(a);
    case Op::tan:
      return std::tan(a);
    case Op::asin:
      return std::asin(a);
    case Op::acos:
      return std::acos(a);
    case Op::atan2:
      return std::atan2(a, b);
    case Op::sqrt:
      return std::sqrt(a);
    case Op::exp:
      return std::exp(a);
    case Op::log:
      return std::log(a);
    case Op::abs:
      return std::abs(a);
    case Op::sign:
      return a > 0 ? 1 : a < 0 ? -1 : 0;
    case Op::less:
      return a < b ? 1 : 0;
    case Op::select:
      return a != 0 ? b : c;
    case Op::floor:
      return std::floor(a);
  }
  return NAN;
}

// The values of `outputs`, all on one tape (or constant), where the leaves have the values `slots`.
inline std::vector<Real> evaluate(const std::vector<Expr>& outputs,
                                  const std::vector<Real>& slots) {
  const Tape* tape = nullptr;
  std::int32_t last = -1;
  for (const Expr& y : outputs)
    if (!y.is_constant()) tape = y.tape(), last = std::max(last, y.node());
  std::vector<Real> value(last + 1);
  auto at = [&](std::int32_t i) { return i < 0 ? Real(0) : value[i]; };
  for (std::int32_t i = 0; i <= last; ++i) {
    const Node& n = (*tape)[i];
    value[i] = n.op == Op::constant ? Real(n.value)
               : n.op == Op::leaf   ? slots[n.a]
                                    : apply(n.op, at(n.a), at(n.b), at(n.c));
  }
  std::vector<Real> result;
  for (const Expr& y : outputs)
    result.push_back(y.is_constant() ? Real(y.constant()) : at(y.node()));
  return result;
}

// d outputs / d slot by central difference with step h.
inline std::vector<Real> difference(const std::vector<Expr>& outputs, std::vector<Real> slots,
                                    std::size_t slot, Real h) {
  static constexpr Real weight[] = {45, -9, 1};
  std::vector<Real> sum(outputs.size());
  const Real here = slots[slot];
  for (int k = 1; k <= 3; ++k)
    for (int side : {1, -1}) {
      slots[slot] = here + side * k * h;
      const std::vector<Real> f = evaluate(outputs, slots);
      for (std::size_t i = 0; i < f.size(); ++i) sum[i] += side * weight[k - 1] * f[i];
    }
  for (Real& s : sum) s /= 60 * h;
  return sum;
}

// The same where steps h and h/2 agree within `tolerance` (relative to 1 or the value, whichever is
// larger); nothing where they do not: beside a corner, or too near a singular place.
inline std::optional<std::vector<Real>> sure_difference(const std::vector<Expr>& outputs,
                                                        const std::vector<Real>& slots,
                                                        std::size_t slot, Real h, Real tolerance) {
  const std::vector<Real> coarse = difference(outputs, slots, slot, h);
  std::vector<Real> fine = difference(outputs, slots, slot, h / 2);
  for (std::size_t i = 0; i < fine.size(); ++i)
    if (!(std::abs(coarse[i] - fine[i]) <= tolerance * std::max(Real(1), std::abs(fine[i]))))
      return {};
  return fine;
}

}  // namespace talus::reference
