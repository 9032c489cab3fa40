#include <fmt/format.h>

#include <algorithm>

#include "framework/kinematics/compiler.h"
#include "framework/kinematics/effect_motion.h"

namespace talus {
namespace {

bool is_identity(const Motion<Expr>& m) {
  return m.kind != Motion<Expr>::Kind::matrix && m.amount.is_constant() && m.amount.constant() == 0;
}

// Leaves out motions by zero.
Rigid<Expr> trimmed(const Rigid<Expr>& t) {
  Rigid<Expr> result;
  for (const Motion<Expr>& m : t.motions())
    if (!is_identity(m)) result = result * Rigid<Expr>(m);
  return result;
}

}  // namespace

void Compiler::feature(const Element& element) {
  const Plugin& plugin = *registry_.find(element.tag);
  const Declaration& d = plugin.declaration;
  Feature f{element.name(), element.tag, d.kinds[0]};
  f.place = element.place;
  auto place_of = [&](const char* attribute) {
    const Attribute* a = element.find(attribute);
    return a ? a->place : element.place;
  };
  const int in = element.find("in") ? program_.frame(element.text("in"), place_of("in")) : 0;
  const int at =
      program_.frame(element.text("at", f.name), place_of(element.find("at") ? "at" : "name"));
  Chain chain{program_.frames[in].name, element.text("at", f.name)};
  Rigid<Expr> offset;
  if (plugin.transform) offset = plugin.transform(inputs(element, d), choices(element, d));
  EffectPlace place{Acts::fixture, "fixture"};
  place.feature = static_cast<int>(program_.features.size());
  const Rigid<Expr> fixture = motion_of(corrections(place, {f.name, "fixture"}));
  Rigid<Expr> tip;
  if (f.kind != Kind::nothing) {  // of a closed loop nothing is measured
    place.acts = Acts::tip, place.location = "measurement";
    tip = motion_of(corrections(place, {f.name, "measurement"}));
  }
  chain.motions = trimmed(fixture * program_.between(in, at) * offset * tip);
  chain.first_slot = program_.slots;
  for (int i = 0; i < 12; ++i) new_slot(fmt::format("{}[{}]", f.name, i));
  f.chain = static_cast<int>(program_.chains.size());
  program_.chains.push_back(std::move(chain));

  const std::string prefix = element.text("columns", f.name);
  std::vector<Expr> leaves;
  for (const Column& column : d.columns) {
    const int slot = new_slot(prefix + column.suffix);
    f.columns.push_back(static_cast<int>(program_.columns.size()));
    program_.columns.push_back(
        {prefix + column.suffix, column.dimension, place_of("columns"), slot});
    leaves.push_back(leaf(slot));
  }
  if (plugin.observe) f.observed = plugin.observe(leaves, choices(element, d));
  f.observed.kind = f.kind;
  f.probed = probed(element, f.kind);
  if (const Attribute* sigma = element.find("sigma")) {
    std::vector<Dimension> expected{length, angle};
    if (f.kind == Kind::direction) expected = {angle};
    const auto words = split_list(*sigma);
    for (std::size_t i = 0; i < words.size(); ++i) {
      // With a unit the word says itself what it is; without one the order does.
      Dimension dimension = expected[std::min(i, expected.size() - 1)];
      const std::size_t letter = words[i].text.find_first_of(
          "abcdefghijklmnopqrstuvwxyz", words[i].text.find_first_of("0123456789."));
      if (letter != std::string::npos)
        if (auto unit = parse_unit(std::string_view(words[i].text).substr(letter)))
          dimension = unit->dimension;
      const double value =
          parse_quantity(words[i].text, dimension, program_.units, words[i].place).value;
      if (!(value > 0))
        throw InputError(words[i].place, fmt::format("sigma '{}'", words[i].text),
                         "more than zero");
      auto& target = dimension == length  ? f.sigma_length
                     : dimension == angle ? f.sigma_angle
                                          : f.sigma_number;
      if (target)
        throw InputError(words[i].place, fmt::format("a second sigma for {}", describe(dimension)),
                         "one of each kind");
      target = value;
    }
  }
  program_.features.push_back(std::move(f));
}

}  // namespace talus
