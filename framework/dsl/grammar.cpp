#include "framework/dsl/grammar.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/model/quantity.h"

namespace talus {
namespace {

constexpr bool required = true;

const std::vector<ElementRule>& structural() {
  static const std::vector<ElementRule> rules = {
      {"talus",
       "A model.",
       Where::root,
       {{"name", "what is modelled"},
        {"length", "unit of the lengths written without one; default mm"},
        {"angle", "unit of the angles written without one; default deg"},
        {"about", "remarks, sources"}}},
      {"include",
       "The children of another model file's root stand here.",
       Where::inside_talus,
       {{"file", "the file, its path relative to this one", required}}},
      {"plugin",
       "A Lua plugin file to load.",
       Where::inside_talus,
       {{"file", "the file, its path relative to this one", required}}},
      {"constant",
       "A fixed number for use in expressions.",
       Where::inside_talus,
       {{"name", "how expressions call it", required},
        {"value", "300, 300 mm, or an expression such as 2*L", required}}},
      {"parameter",
       "A named parameter; used in several places it is one parameter.",
       Where::inside_talus,
       {{"name", "how expressions call it", required},
        {"value", "number with its tolerance: 300 ± 0.5", required},
        {"kind", "length, angle, number (default), or a unit such as deg/(N*m)"}}},
      {"unknown",
       "A number that the solver finds for each pose or group of poses.",
       Where::inside_talus,
       {{"name", "how expressions call it", required},
        {"value",
         "its start, with a tolerance if there is a prior: 50 ± 0.1; bounds are the range "
         "simulated"},
        {"kind", "length, angle, number (default), or a unit such as deg/(N*m)"},
        {"per", "pose (default), or the columns whose equal values make a group"}}},
      {"chain",
       "Joints from one frame to another, in order.",
       Where::inside_talus,
       {{"from", "frame before the first joint", required},
        {"to", "frame behind the last joint", required}}},
      {"gravity",
       "The direction and size of gravity.",
       Where::inside_talus,
       {{"in", "frame in which the direction is given; default the root"},
        {"x", "component of the direction along x"},
        {"y", "component of the direction along y"},
        {"z", "component of the direction along z"},
        {"magnitude", "acceleration, m/s^2; default 9.81"},
        {"held_at", "frame that something holds as well as the root: no joint carries a torque"}}},
      {"payload",
       "A point mass at a frame's origin.",
       Where::inside_talus,
       {{"name", "how reports call it"},
        {"at", "the frame that carries it", required},
        {"column", "column of the recordings that gives its mass, in kg"},
        {"mass", "its mass where that is always the same: 2 kg"},
        {"range", "least and greatest mass that may be hung there, for poses to record: 0, 5 kg"}}},
      {"datum",
       "A frame made of probed shapes, as a coordinate measuring machine constructs it.",
       Where::inside_talus,
       {{"name", "how features call it", required},
        {"origin", "the shapes it lies on: a circle or sphere (its centre), or axis, plane",
         required},
        {"primary", "an axis and the shape whose axis it is: y=face, or y=-face", required},
        {"secondary", "an axis and the shape whose axis it comes as near as it can: x=side"},
        {"check", "an axis and a shape that should follow it: is the whole square?"},
        {"square", "how far from square the shapes' axes may be: 0.2 deg"}}},
      {"limb",
       "A body that a frame carries, a cuboid: shown in pictures, listed in tables of motion.",
       Where::inside_talus,
       {{"name", "how pictures and tables call it", required},
        {"at", "the frame that carries it; default the limb's name"},
        {"length", "its edge along x of the frame", required},
        {"width", "its edge along y", required},
        {"height", "its edge along z", required},
        {"x", "its centre in the frame, along x; default 0"},
        {"y", "along y; default 0"},
        {"z", "along z; default 0"}}},
      {"calibrate",
       "Which residuals of which measured features are made small, and how.",
       Where::inside_talus,
       {{"residual", "one residual or several: position, rotation_vector", required},
        {"of", "the measured features: E, or E, F; default: all that the residual fits"},
        {"weight", "one number per residual; without it each row is divided by its sigma"},
        {"normalise", "fsr: each row is divided by its full-scale range first", false, {"fsr"}},
        {"objective",
         "as_published: the weighted sum of squares of a pose squared again",
         false,
         {"least_squares", "as_published"}},
        {"loss", "robust loss in sigmas: huber 2, or cauchy 2"},
        {"group", "columns whose equal rows are held out together: star"}}}};
  return rules;
}

AttributeRule rule_of(const Input& input) {
  std::string meaning = input.meaning + "; " + describe(input.dimension);
  if (!input.required)
    meaning += "; default " + write_quantity({.value = input.otherwise}, input.dimension, {});
  return {input.name, meaning, input.required};
}

void append(std::vector<AttributeRule>& to, std::vector<AttributeRule> more) {
  for (AttributeRule& rule : more)
    if (std::none_of(to.begin(), to.end(), [&](auto& r) { return r.name == rule.name; }))
      to.push_back(std::move(rule));
}

// Where effects may act, in words; and whether the model must say so.
std::string at_words(const EffectTraits& effect) {
  if (effect.everywhere && effect.acts == Acts::reading) return "all readings";
  switch (effect.acts) {
    case Acts::reading:
      return "a sensor";
    case Acts::coordinate:
    case Acts::axis:
    case Acts::about:
      return "a joint";
    case Acts::link:
      return "a link";
    case Acts::lengths:
      return "a link; default all links";
    case Acts::fixture:
      return "fixture (default), or a measured feature";
    default:
      return "measurement (default), or a measured feature";
  }
}

bool needs_at(const EffectTraits& effect) {
  return !effect.everywhere &&
         (effect.acts == Acts::reading || effect.acts == Acts::coordinate ||
          effect.acts == Acts::axis || effect.acts == Acts::about || effect.acts == Acts::link);
}

ElementRule rule_of(const Declaration& d) {
  ElementRule rule{d.tag, d.summary};
  if (d.family == Family::joint) rule.where = Where::inside_chain;
  const char* name = d.family == Family::joint    ? "its name and that of the frame behind it"
                     : d.family == Family::sensor ? "how expressions call its calibrated value"
                     : d.family == Family::shape  ? "how the points' table and datums call it"
                     : d.family == Family::effect
                         ? "how its amounts are called; default its tag and place"
                         : "how its results and residuals are called";
  rule.attributes = {{"name", name, d.family != Family::effect}};
  if (d.family == Family::effect) {
    rule.attributes.push_back({"at", "where it acts: " + at_words(d.effect), needs_at(d.effect)});
    if (d.effect.driven != Driven::no)
      rule.attributes.push_back({"driver", d.effect.driver_meaning, required});
  }
  for (const Input& input : d.inputs)
    if (input.role != Role::borrowed) append(rule.attributes, {rule_of(input)});
  for (const Choice& choice : d.choices)
    append(rule.attributes,
           {{choice.name, choice.meaning + "; default " + choice.words[0], false, choice.words}});
  if (d.family == Family::joint)
    append(rule.attributes,
           {{"mass", "mass of the link behind the joint: 0.18 kg"},
            {"com", "its centre of mass in the frame behind the joint: 0, 0, 20"},
            {"link", "name of that link; default link3 for joint3, else the joint's name"}});
  if (d.family == Family::sensor)
    append(rule.attributes, {{"column", "column of the recordings; default the sensor's name"},
                             {"sigma", "standard deviation of the reading's noise"},
                             {"range", "lowest and highest reading: -120, 30"}});
  if (d.family == Family::feature)
    append(rule.attributes,
           {{"in", "frame in which it is measured"},
            {"at", "frame to which it belongs; default the feature's name"},
            {"columns", "prefix of its columns; default the feature's name"},
            {"sigma", "standard deviations of the measurement: 0.005 mm, 0.002 deg"},
            {"probed", "what is probed for it instead of columns: E_datum in B_datum"}});
  if (d.family == Family::shape)
    append(rule.attributes,
           {{"on", "a plane on which the points are projected first"},
            {"through", "shapes whose centres are its points, instead of probed points"},
            {"radius", "its radius, where that is known"},
            {"sigma", "standard deviation of a probed point; default: from the fits themselves"},
            {"at", "the frame on which it lies, for simulation"},
            {"probe", "where it is probed, in that frame: x, y, z; x, y, z"}});
  return rule;
}

ElementRule with_residual_inputs(ElementRule rule, const Registry& registry) {
  for (const std::string& tag : registry.tags(Family::residual))
    for (const Input& input : registry.find(tag, Family::residual)->declaration.inputs) {
      AttributeRule attribute = rule_of(input);
      attribute.required = false;  // of this one residual only
      append(rule.attributes, {std::move(attribute)});
    }
  return rule;
}

ElementRule whole(const ElementRule& rule, const Registry& registry) {
  return rule.tag == "calibrate" ? with_residual_inputs(rule, registry) : rule;
}

}  // namespace

const AttributeRule* ElementRule::find(std::string_view attribute) const {
  for (const AttributeRule& rule : attributes)
    if (rule.name == attribute) return &rule;
  return nullptr;
}

std::vector<std::string> ElementRule::names() const {
  std::vector<std::string> result;
  for (const AttributeRule& rule : attributes) result.push_back(rule.name);
  return result;
}

std::optional<ElementRule> rule_of(std::string_view tag, const Registry& registry) {
  for (const ElementRule& rule : structural())
    if (rule.tag == tag) return whole(rule, registry);
  for (Family family :
       {Family::joint, Family::sensor, Family::feature, Family::shape, Family::effect})
    if (const Plugin* plugin = registry.find(tag, family)) return rule_of(plugin->declaration);
  return {};
}

std::vector<ElementRule> all_rules(const Registry& registry) {
  std::vector<ElementRule> result;
  for (const ElementRule& rule : structural()) result.push_back(whole(rule, registry));
  for (const Plugin* plugin : registry.all())
    if (plugin->declaration.family != Family::residual)
      result.push_back(rule_of(plugin->declaration));
  return result;
}

bool is_structural(std::string_view tag) {
  const auto& all = structural();
  return std::any_of(all.begin(), all.end(), [&](const ElementRule& r) { return r.tag == tag; });
}

bool is_reserved(std::string_view input, Family family) {
  if (family != Family::residual) return rule_of(Declaration{.family = family}).find(input);
  for (const ElementRule& rule : structural())
    if (rule.tag == "calibrate") return rule.find(input);
  return false;
}

std::vector<std::string> split_list(std::string_view text) {
  std::vector<std::string> result;
  while (true) {
    const std::size_t comma = text.find(',');
    std::string_view part = text.substr(0, comma);
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    result.emplace_back(part);
    if (comma == std::string_view::npos) return result;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace talus
