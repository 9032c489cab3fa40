// An element of a plugin, everything given, in a whole model: written and read in both syntaxes.
// An effect's model is compiled as well, so that it is seen to act at its place.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "framework/dsl/dsl.h"
#include "framework/kinematics/program.h"
#include "framework/model/quantity.h"
#include "tests/support/derivative_check.h"
#include "tests/support/effect_check.h"

namespace talus::testing {

// A whole model around one element of the plugin in which everything that can be given is given.
inline Model example_model(const Plugin& plugin, const std::vector<int>& choices, Random& random) {
  const Declaration& d = plugin.declaration;
  const UnitSystem units;
  auto element = [](std::string tag, std::vector<std::pair<std::string, std::string>> attributes) {
    Element e{.tag = std::move(tag)};
    for (auto& [name, text] : attributes) e.set(name, text);
    return e;
  };
  Model model{
      .root = element(
          "talus", {{"name", "example \"<&'\" of " + d.tag}, {"length", "mm"}, {"angle", "deg"}})};
  auto& body = model.root.children;

  Element tested = element(d.family == Family::residual ? "calibrate" : d.tag, {});
  if (d.family == Family::residual)
    tested.set("residual", d.tag), tested.set("of", "seen");
  else
    tested.set("name", d.family == Family::feature ? "seen" : "tested");
  const Dimension corrected = d.family == Family::effect ? corrected_by(d)[0] : number;
  for (Input input : d.inputs) {
    if (input.role == Role::borrowed) continue;
    if (input.relative) input.dimension = input.dimension * corrected;
    Quantity q{
        .value = sensible(random, input), .free = true, .tolerance = between(random, 0.1, 1)};
    if (input.role == Role::setting) q = {.value = input.otherwise};
    if (!input.coordinate) {
      tested.set(input.name, write_quantity(q, input.dimension, units));
      continue;
    }
    body.push_back(element(
        "unknown", {{"name", "q_" + input.name},
                    {"value", write_quantity(q, input.dimension, units)},
                    {"kind", input.dimension == length  ? "length"
                             : input.dimension == angle ? "angle"
                                                        : units.of(input.dimension).text}}));
    tested.set(input.name, "q_" + input.name);
  }
  for (std::size_t i = 0; i < choices.size(); ++i)
    tested.set(d.choices[i].name, d.choices[i].words[choices[i]]);

  Element chain = element("chain", {{"from", "B"}, {"to", "E"}});
  if (d.family == Family::joint)
    chain.children.push_back(tested);
  else if (d.family == Family::effect)
    chain.children = {
        element("dh", {{"name", "joint"}, {"theta", "sensed"}, {"d", "40"}, {"a", "300"}}),
        element("dh", {{"name", "joint2"}, {"theta", "other"}, {"a", "70"}, {"alpha", "80"}})};
  else
    chain.children.push_back(element("dh", {{"name", "joint"}, {"theta", "10 ± 1"}, {"a", "300"}}));
  body.push_back(std::move(chain));
  if (d.family == Family::sensor) {
    tested.set("column", "reading"), tested.set("sigma", "0.01");
    body.push_back(tested);
  }
  if (d.family == Family::feature) {
    tested.set("in", "B"), tested.set("at", "E");
    if (!d.columns.empty()) tested.set("columns", "E");
    body.push_back(tested);
  }
  if (d.family == Family::shape) {
    tested.set("at", "E"), tested.set("sigma", "0.005"), tested.set("probe", "0, 0, 1; 1, 0, 0");
    body.push_back(tested);
  }
  if (d.family == Family::effect) {
    const Acts acts = d.effect.acts;
    if (acts == Acts::reading && !d.effect.everywhere)
      tested.set("at", "sensed");
    else if (acts == Acts::coordinate || acts == Acts::axis || acts == Acts::about ||
             acts == Acts::link)
      tested.set("at", "joint");
    if (d.effect.driven != Driven::no) tested.set("driver", "joint2");
    body.push_back(
        corrected == length
            ? element("micrometer_triangle", {{"name", "sensed"}, {"bar1", "60"}, {"bar2", "50"}})
            : element("encoder", {{"name", "sensed"}}));
    body.push_back(element("encoder", {{"name", "other"}}));
    const bool direction = acts == Acts::measured && corrected == number;
    body.push_back(
        element(direction ? "direction" : "frame", {{"name", "seen"}, {"in", "B"}, {"at", "E"}}));
    body.push_back(tested);
  }
  if (d.family == Family::residual) {
    for (const auto& [kind, tag] : {std::pair{Kind::frame, "frame"},
                                    {Kind::point, "point"},
                                    {Kind::direction, "direction"},
                                    {Kind::scalar, "length"},
                                    {Kind::nothing, "closure"}})
      if (kind == d.kinds.at(0))
        body.push_back(element(tag, {{"name", "seen"}, {"in", "B"}, {"at", "E"}}));
    body.push_back(tested);
  }
  return model;
}

inline void check_round_trip(const Plugin& plugin, const std::vector<int>& choices,
                             Random& random) {
  Registry registry = Registry::built_in();
  if (!registry.find(plugin.declaration.tag, plugin.declaration.family)) registry.add(plugin);
  const Model model = example_model(plugin, choices, random);
  const std::string xml = write_xml(model), lua = write_lua(model);
  CAPTURE(xml);
  CAPTURE(lua);
  const Model from_xml = read_xml(xml, "example.xml", registry);
  const Model from_lua = read_lua(lua, "example.lua", registry);
  CHECK(same(from_xml.root, model.root));
  CHECK(same(from_lua.root, model.root));
  if (plugin.declaration.family != Family::effect) return;
  const Program program = compile(from_xml, registry);
  for (const Input& input : plugin.declaration.inputs) {
    const std::string& name = input.name;
    CAPTURE(name);
    CHECK(std::count_if(program.parameters.begin(), program.parameters.end(),
                        [&](const Parameter& p) { return p.attribute == name; }) ==
          (input.role == Role::amount));
  }
}

}  // namespace talus::testing
