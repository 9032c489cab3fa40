// What every effect must keep, wherever it comes from: it declares all that it uses, everything
// declared does something, and with all amounts at zero it is exactly nothing, whatever the
// circumstances (a load of zero and a link without length included).
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "framework/registry/registry.h"
#include "tests/support/derivative_check.h"

namespace talus::testing {

// The readings or coordinates that an effect corrects.
inline std::vector<Dimension> corrected_by(const Declaration& d) {
  return d.effect.on.empty() ? std::vector<Dimension>{angle, length} : d.effect.on;
}

// All dimensions that an input can have.
inline std::vector<Dimension> dimensions_of(const Input& input, const Declaration& d) {
  if (!input.relative) return {input.dimension};
  std::vector<Dimension> result;
  for (Dimension reading : corrected_by(d)) result.push_back(input.dimension * reading);
  return result;
}

inline void check_traits(const Declaration& d) {
  const EffectTraits& effect = d.effect;
  const auto is = [&](const std::string& name, Role role) {
    CAPTURE(name);
    const Input* input = d.find_input(name);
    REQUIRE(input);
    CHECK(input->role == role);
  };
  int amounts = 0;
  for (const Input& input : d.inputs) {
    CAPTURE(input.name);
    for (double value : input.tries) CHECK(std::isfinite(value));
    if (input.role != Role::amount) continue;
    ++amounts;
    CHECK(input.otherwise == 0);
    if (!input.relative || corrected_by(d)[0] == angle) CHECK(input.typical > 0);
    if (input.relative && corrected_by(d).back() == length) CHECK(input.typical_length > 0);
  }
  CHECK(amounts > 0);
  for (const EffectForm& form : effect.forms) {
    CHECK(!form.amounts.empty());
    for (const std::string& amount : form.amounts) is(amount, Role::amount);
    CHECK((form.driven == Driven::no || effect.driven != Driven::no));
  }
  for (const Figure& figure : effect.figures) {
    CHECK(!figure.name.empty());
    for (const std::string& amount : figure.amounts) is(amount, Role::amount);
  }
  if (!effect.onset.empty()) is(effect.onset, Role::setting);
  CHECK((effect.driven == Driven::no) == effect.driver_meaning.empty());
  CHECK(std::set<Covariate>(effect.needs.begin(), effect.needs.end()).size() ==
        effect.needs.size());
  if (!effect.same_as.empty()) CHECK(Registry::built_in().find(effect.same_as, Family::effect));
}

// Circumstances as leaves; what the declaration does not ask for is a leaf as well, and must not be
// used.
struct Circumstances {
  Around<Expr> around;
  std::set<int> allowed;  // slots

  Circumstances(Leaves& leaves, const Declaration& d, Dimension corrected) {
    const Acts acts = d.effect.acts;
    auto add = [&](Expr& e, Dimension dimension, bool asked_for) {
      e = leaves.add(dimension);
      if (asked_for) allowed.insert(static_cast<int>(leaves.drawn.size()) - 1);
    };
    auto add3 = [&](Vector3<Expr>& v, Dimension dimension, bool asked_for) {
      for (Expr& e : v) add(e, dimension, asked_for);
    };
    auto needs = [&](Covariate c) {
      return std::find(d.effect.needs.begin(), d.effect.needs.end(), c) != d.effect.needs.end();
    };
    const bool at_joint = acts == Acts::coordinate || acts == Acts::axis || acts == Acts::about ||
                          acts == Acts::link || acts == Acts::lengths;
    add(around.reading, corrected, acts == Acts::reading);
    add(around.coordinate, corrected, at_joint);
    add(around.driver, angle, d.effect.driven != Driven::no);
    add(around.approach, number, needs(Covariate::approach));
    add(around.time, duration, needs(Covariate::time));
    add(around.session, number, needs(Covariate::session));
    add(around.pose, number, needs(Covariate::pose));
    add(around.temperature, temperature, needs(Covariate::temperature));
    add(around.rate, corrected / duration, needs(Covariate::rate));
    add(around.travel, corrected, needs(Covariate::travel));
    add(around.since, duration, needs(Covariate::since));
    add3(around.force, force, needs(Covariate::load));
    add3(around.moment, torque, needs(Covariate::load));
    for (Vector3<Expr>* v : {&around.tip_force, &around.tip_moment, &around.weight})
      add3(*v, force, needs(Covariate::tip_load));
    add3(around.span, length, needs(Covariate::tip_load));
    add3(around.own_moment, torque, needs(Covariate::tip_load));
    add3(around.position, corrected == number ? number : length, acts == Acts::measured);
  }
};

// How to draw an input: amounts of size one, whatever their usual size, so that a wrong derivative
// is not lost in rounding; settings near their default; a sensor's bars as lengths of a triangle.
inline Input drawn_as(Input input, Dimension corrected) {
  if (input.relative) input.dimension = input.dimension * corrected;
  if (input.role == Role::borrowed) input.required = true;
  if (input.role == Role::amount) input.dimension = number;
  if (input.role == Role::setting && !input.tries.empty()) input.otherwise = input.tries[0];
  return input;
}

inline double value_of(const Expr& e, const std::vector<double>& slots) {
  return e.is_constant() ? e.constant() : e.tape()->evaluate(e.node(), slots);
}

inline void check_act(const Plugin& plugin, const std::vector<int>& choices, Random& random) {
  const Declaration& d = plugin.declaration;
  for (Dimension corrected : corrected_by(d)) {
    Leaves leaves;
    const Circumstances circumstances(leaves, d, corrected);
    std::vector<Expr> inputs, nothing;
    std::set<int> amounts, declared = circumstances.allowed;
    for (const Input& input : d.inputs) {
      inputs.push_back(leaves.add(drawn_as(input, corrected)));
      const int slot = static_cast<int>(leaves.drawn.size()) - 1;
      declared.insert(slot);
      if (input.role == Role::amount) amounts.insert(slot);
      nothing.push_back(input.role == Role::amount ? Expr(0) : inputs.back());
    }
    const std::vector<Expr> act = plugin.act(circumstances.around, inputs, choices);
    REQUIRE(static_cast<int>(act.size()) == parts_of(d.effect.acts));
    check_derivatives(act, leaves, random);

    std::set<int> used;
    for (const Expr& e : act)
      for (int slot : support(e)) used.insert(slot);
    for (int slot : used) {
      CAPTURE(slot);
      CHECK(declared.contains(slot));
    }
    for (std::size_t i = 0; i < d.inputs.size(); ++i) {
      const std::string& input = d.inputs[i].name;
      CAPTURE(input);
      CHECK(used.contains(support(inputs[i])[0]));
    }

    const std::vector<Expr> none = plugin.act(circumstances.around, nothing, choices);
    for (int trial = 0; trial < 5; ++trial) {
      std::vector<double> slots;
      for (std::size_t s = 0; s < leaves.drawn.size(); ++s) {
        const bool circumstance = circumstances.allowed.contains(static_cast<int>(s));
        slots.push_back(trial == 0 && circumstance ? 0 : sensible(random, leaves.drawn[s]));
        if (amounts.contains(static_cast<int>(s))) slots.back() = 0;
      }
      if (trial > 0 && !std::isfinite(value_of(act[0], slots))) continue;  // no such triangle
      for (std::size_t i = 0; i < act.size(); ++i) {
        CAPTURE(i);
        CHECK(value_of(none[i], slots) == 0);
        if (trial == 0 && !std::isfinite(value_of(act[i], slots))) continue;
        CHECK(value_of(act[i], slots) == 0);
      }
    }
  }
}

}  // namespace talus::testing
