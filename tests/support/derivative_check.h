// Exact derivatives against the independent reference, at seeded random points.
//
//     Leaves leaves;
//     const Expr x = leaves.add(length);
//     check_derivatives({f(x)}, leaves, random);
#pragma once

#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "framework/registry/plugin.h"
#include "tests/support/reference.h"

namespace talus::testing {

using Random = std::mt19937_64;

inline double between(Random& random, double low, double high) {
  return low + (high - low) * double(random() >> 11) * 0x1p-53;  // the same on every platform
}

// A sensible value: angles and plain numbers within 1 of their default, lengths within 50 mm; what
// must be given and is no coordinate (a triangle's side) is positive.
inline double sensible(Random& random, const Input& input) {
  const bool size = input.required && !input.coordinate;
  if (input.dimension == length)
    return size ? between(random, 20, 70) : input.otherwise + between(random, -50, 50);
  return size ? between(random, 0.5, 1.5) : input.otherwise + between(random, -1, 1);
}

// Leaves on a tape, with the way to draw a value for each.
struct Leaves {
  Tape tape;
  std::vector<Input> drawn;

  Expr add(const Input& like) {
    drawn.push_back(like);
    return Expr::leaf(tape, static_cast<std::int32_t>(drawn.size()) - 1);
  }
  Expr add(Dimension dimension, double middle = 0) { return add(Input{"", dimension, middle}); }
  std::vector<Expr> add(const std::vector<Input>& inputs) {
    std::vector<Expr> result;
    for (const Input& input : inputs) result.push_back(add(input));
    return result;
  }
  // A proper rigid transform of six leaves, handed over as a matrix.
  Rigid<Expr> transform() {
    const Expr x = add(angle), y = add(angle), z = add(angle);
    const Matrix3<Expr> R = rotate_by_vector(x, y, z).rotation();
    return {R, {add(length), add(length), add(length)}};
  }
};

inline std::vector<Expr> entries(const Rigid<Expr>& t) {
  std::vector<Expr> result;
  const auto R = t.rotation();
  for (const auto& row : R) result.insert(result.end(), row.begin(), row.end());
  const auto p = t.translation();
  result.insert(result.end(), p.begin(), p.end());
  return result;
}

// Compares exact and differenced derivatives at `wanted` points where the function is defined.
inline void check_derivatives(const std::vector<Expr>& outputs, const Leaves& leaves,
                              Random& random, int wanted = 4) {
  using reference::Real;
  std::vector<std::unordered_map<std::int32_t, Expr>> gradients;
  for (const Expr& y : outputs) gradients.push_back(gradient(y));
  int found = 0;
  for (int trial = 0; trial < 100 * wanted && found < wanted; ++trial) {
    std::vector<double> slots;
    for (const Input& input : leaves.drawn) slots.push_back(sensible(random, input));
    const std::vector<Real> point(slots.begin(), slots.end());
    std::vector<std::vector<Real>> expected;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      auto d = reference::sure_difference(outputs, point, s, 1e-3L, 1e-11L);
      if (!d) break;
      expected.push_back(std::move(*d));
    }
    if (expected.size() < slots.size()) continue;  // not defined here, or beside a corner
    ++found;
    const std::vector<Real> values = reference::evaluate(outputs, point);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      CAPTURE(i);
      const Expr& y = outputs[i];
      const double value = y.is_constant() ? y.constant() : y.tape()->evaluate(y.node(), slots);
      CHECK(std::abs(value - values[i]) <= 1e-12L * std::max(Real(100), std::abs(values[i])));
      for (std::size_t s = 0; s < slots.size(); ++s) {
        CAPTURE(s);
        const auto it = gradients[i].find(static_cast<std::int32_t>(s));
        const Expr g = it == gradients[i].end() ? Expr(0) : it->second;
        const double exact = g.is_constant() ? g.constant() : g.tape()->evaluate(g.node(), slots);
        const double difference = static_cast<double>(expected[s][i]);
        CAPTURE(exact);
        CAPTURE(difference);
        CHECK(std::abs(exact - difference) <= 1e-9 * std::max(1.0, std::abs(difference)));
      }
    }
  }
  CHECK(found == wanted);
}

}  // namespace talus::testing
