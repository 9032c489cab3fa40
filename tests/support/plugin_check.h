// The test that every plugin falls under by being registered, wherever it comes from: built in, a
// shared library, a Lua file.
//
//     check_plugin(*registry.find("dh"));
//
// It checks the declaration (everything explained, units writable and readable), the derivatives of
// all that the plugin computes, for every combination of its choices and every kind it accepts,
// against an independent difference in long double, and that an element of it survives writing and
// reading in both syntaxes. What is asked of effects besides: effect_check.h.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "framework/registry/choices.h"
#include "framework/registry/registry.h"
#include "tests/support/derivative_check.h"
#include "tests/support/effect_check.h"
#include "tests/support/round_trip_check.h"

namespace talus::testing {

// ---- declaration -------------------------------------------------------------------------------

inline void check_units(Dimension dimension) {
  const UnitSystem units;
  const Unit unit = units.of(dimension);
  CAPTURE(unit.text);
  const auto read = parse_unit(unit.text);
  REQUIRE(read);
  CHECK(read->dimension == dimension);
  CHECK(read->factor == doctest::Approx(unit.factor).epsilon(1e-15));
  for (double value : {0.0, 1.5, -0.25}) {
    const Quantity written{.value = value, .free = true, .tolerance = 0.5};
    const Quantity q =
        parse_quantity(write_quantity(written, dimension, units), dimension, units, {});
    CHECK(q.value == doctest::Approx(value).epsilon(1e-15));
    CHECK(q.free);
    CHECK(q.tolerance.value_or(-1) == doctest::Approx(0.5).epsilon(1e-15));
  }
}

inline void check_declaration(const Declaration& d) {
  CHECK(d.summary.size() > 10);
  CHECK(d.summary.find('\n') == std::string::npos);
  std::set<std::string> names{"name"}, suffixes;
  for (const Input& input : d.inputs) {
    CAPTURE(input.name);
    CHECK(input.meaning.size() > 3);
    CHECK(names.insert(input.name).second);
    CHECK((!input.coordinate || d.family == Family::joint));
    CHECK((!input.coordinate || input.required));
    CHECK((input.role == Role::plain) == (d.family != Family::effect));
    for (Dimension dimension : dimensions_of(input, d)) check_units(dimension);
  }
  for (const Choice& choice : d.choices) {
    CAPTURE(choice.name);
    CHECK(choice.meaning.size() > 3);
    CHECK(names.insert(choice.name).second);
    CHECK(choice.words.size() > 1);
    CHECK(std::set<std::string>(choice.words.begin(), choice.words.end()).size() ==
          choice.words.size());
  }
  for (const Column& column : d.columns) {
    CHECK(suffixes.insert(column.suffix).second);
    check_units(column.dimension);
  }
  if (d.family == Family::sensor) check_units(d.reading), check_units(d.value);
  if (d.family == Family::residual) CHECK(!d.kinds.empty());
  if (d.family == Family::shape) {
    CHECK(d.freedom > 0);
    CHECK(d.points > 1);
  }
  if (d.family == Family::effect) check_traits(d);
}

// ---- what the plugin computes ------------------------------------------------------------------

// What can be observed of a kind, from leaves: one case, or two for a direction.
inline std::vector<std::function<Observed<Expr>(Leaves&)>> observations(Kind kind) {
  using Make = std::function<Observed<Expr>(Leaves&)>;
  const Make frame = [](Leaves& l) {
    return Observed<Expr>{.kind = Kind::frame, .frame = l.transform()};
  };
  const Make point = [](Leaves& l) {
    return Observed<Expr>{.kind = Kind::point,
                          .frame = translate(l.add(length), l.add(length), l.add(length))};
  };
  const Make components = [](Leaves& l) {
    const Matrix3<Expr> R = l.transform().rotation();
    return Observed<Expr>{.kind = Kind::direction, .vector = column(R, 2)};
  };
  const Make angles = [](Leaves& l) {
    Observed<Expr> o{.kind = Kind::direction, .angles = true};
    for (Expr& a : o.vector) a = l.add(angle, 1.5);
    return o;
  };
  const Make scalar = [](Leaves& l) {
    return Observed<Expr>{.kind = Kind::scalar, .scalar = l.add(length)};
  };
  const Make nothing = [](Leaves&) { return Observed<Expr>{}; };
  switch (kind) {
    case Kind::frame:
      return {frame};
    case Kind::point:
      return {point};
    case Kind::direction:
      return {components, angles};
    case Kind::scalar:
      return {scalar};
    case Kind::nothing:
      return {nothing};
  }
  return {};
}

inline void check_functions(const Plugin& plugin, const std::vector<int>& choices, Random& random) {
  const Declaration& d = plugin.declaration;
  if (plugin.transform) {
    Leaves leaves;
    const auto inputs = leaves.add(d.inputs);
    check_derivatives(entries(plugin.transform(inputs, choices)), leaves, random);
  }
  if (plugin.value) {
    Leaves leaves;
    const Expr reading = leaves.add(d.reading);
    const auto inputs = leaves.add(d.inputs);
    check_derivatives({plugin.value(reading, inputs, choices)}, leaves, random);
  }
  if (plugin.observe) {
    Leaves leaves;
    std::vector<Expr> columns;
    for (const Column& column : d.columns) columns.push_back(leaves.add(column.dimension));
    const Observed<Expr> o = plugin.observe(columns, choices);
    CHECK(o.kind == d.kinds.at(0));
    std::vector<Expr> outputs = entries(o.frame);
    outputs.insert(outputs.end(), o.vector.begin(), o.vector.end());
    outputs.push_back(o.scalar);
    check_derivatives(outputs, leaves, random);
  }
  if (plugin.deviations) {
    Leaves leaves;
    const Vector3<Expr> point{leaves.add(length), leaves.add(length), leaves.add(length)};
    check_derivatives(plugin.deviations(point, leaves.add(length)), leaves, random);
  }
  if (plugin.act) check_act(plugin, choices, random);
  if (plugin.rows)
    for (Kind kind : d.kinds)
      for (const auto& observe : observations(kind)) {
        CAPTURE(to_string(kind));
        Leaves leaves;
        const Rigid<Expr> model = leaves.transform();
        const Observed<Expr> measured = observe(leaves);
        const auto rows = plugin.rows(model, measured, leaves.add(d.inputs), choices);
        CHECK(rows.size() == d.columns.size());
        check_derivatives(rows, leaves, random);
      }
}

// ------------------------------------------------------------------------------------------------

inline void check_plugin(const Plugin& plugin) {
  const Declaration& d = plugin.declaration;
  const std::string tested = to_string(d.family) + " " + d.tag;
  CAPTURE(tested);
  Random random(1);
  check_declaration(d);
  for (const auto& choices : combinations(d.choices)) {
    std::string words;
    for (std::size_t i = 0; i < choices.size(); ++i) words += d.choices[i].words[choices[i]] + " ";
    CAPTURE(words);
    check_functions(plugin, choices, random);
    check_round_trip(plugin, choices, random);
  }
}

}  // namespace talus::testing
