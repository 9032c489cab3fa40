#include <fmt/format.h>
#include <algorithm>
#include <cctype>

#include "framework/kinematics/compiler.h"

namespace talus {

std::vector<Attribute> split_list(const Attribute& attribute) {
  std::vector<Attribute> words;
  std::size_t start = 0;
  while (start <= attribute.text.size()) {
    std::size_t end = attribute.text.find(',', start);
    if (end == std::string::npos) end = attribute.text.size();
    std::size_t a = start, b = end;
    auto blank = [&](std::size_t i) {
      return std::isspace(static_cast<unsigned char>(attribute.text[i]));
    };
    while (a < b && blank(a)) ++a;
    while (b > a && blank(b - 1)) --b;
    Place place = attribute.place;
    if (place.column > 0) {
      const std::string before = attribute.text.substr(0, a);
      const std::size_t line = before.rfind('\n');
      place.line += static_cast<int>(std::count(before.begin(), before.end(), '\n'));
      place.column = line == std::string::npos ? place.column + static_cast<int>(a)
                                               : static_cast<int>(a - line);
    }
    words.push_back({attribute.name, attribute.text.substr(a, b - a), place});
    start = end + 1;
  }
  return words;
}

Compiler::Compiler(const Model& model, const Registry& registry)
    : model_(model), registry_(registry) {
  program_.name = model.root.name();
  auto unit = [&](const char* attribute, Dimension dimension, Unit& target) {
    const Attribute* a = model.root.find(attribute);
    if (!a) return;
    auto parsed = parse_unit(a->text);
    if (!parsed || !(parsed->dimension == dimension))
      throw InputError(a->place, fmt::format("{}=\"{}\"", attribute, a->text), describe(dimension));
    target = *parsed;
  };
  unit("length", length, program_.units.length);
  unit("angle", angle, program_.units.angle);
  collect(model.root);
}

void Compiler::collect(const Element& element) {
  if (&element != &model_.root && !element.name().empty() && element.tag != "limb")
    named_.emplace(element.name(), &element);
  for (const Element& child : element.children) collect(child);
}

int Compiler::new_slot(const std::string& name) {
  program_.slot_names.push_back(name);
  return program_.slots++;
}

Dimension Compiler::kind(const Element& element) const {
  const Attribute* a = element.find("kind");
  if (!a || a->text == "number") return number;
  if (a->text == "length") return length;
  if (a->text == "angle") return angle;
  auto unit = parse_unit(a->text);
  if (!unit)
    throw InputError(a->place, fmt::format("kind=\"{}\"", a->text),
                     "length, angle, number or a unit");
  return unit->dimension;
}

Expr Compiler::free_parameter(const std::string& name, const std::string& owner,
                              const Attribute& attribute, Dimension dimension,
                              const Quantity& quantity) {
  const int slot = new_slot(name);
  program_.parameters.push_back(
      {name, owner, attribute.name, dimension, quantity, attribute.place, slot});
  return leaf(slot);
}

Term Compiler::quantity_or_expression(const std::string& name, const std::string& owner,
                                      const Attribute& attribute, Dimension dimension) {
  const Resolve names = [this](const std::string& n, const Place& p) { return resolve(n, p); };
  if (looks_like_quantity(attribute.text)) {
    std::optional<Quantity> q;
    try {
      q = parse_quantity(attribute.text, dimension, program_.units, attribute.place);
    } catch (const InputError&) {  // "2*L" starts like a quantity but is an expression
      if (attribute.text.find_first_of("*/^(") == std::string::npos) throw;
    }
    if (q && !q->free) return {Expr(q->value), dimension};
    if (q) return {free_parameter(name, owner, attribute, dimension, *q), dimension};
  }
  const Term term = parse_expression(attribute.text, attribute.place, names);
  if (!(term.dimension == dimension))
    throw InputError(
        attribute.place,
        fmt::format("{}=\"{}\" is {}", attribute.name, attribute.text, describe(term.dimension)),
        describe(dimension));
  return term;
}

// <calibrate> has no name of its own: the first is `calibrate`, then `calibrate2`, ... An effect
// without a name is called by its tag and place: `backlash_joint4`.
std::string Compiler::owner(const Element& element) const {
  int number = 0;
  for (const Element& child : model_.root.children) {
    number += child.tag == "calibrate";
    if (&child == &element && child.tag == "calibrate")
      return number == 1 ? "calibrate" : fmt::format("calibrate{}", number);
  }
  if (element.name().empty() && registry_.find(element.tag, Family::effect))
    return element.find("at") ? element.tag + "_" + element.text("at") : element.tag;
  return element.name();
}

Term Compiler::input(const Element& element, const Input& input) {
  const std::string name = owner(element) + "." + input.name;
  if (auto it = known_.find(name); it != known_.end()) return it->second;
  const Attribute* attribute = element.find(input.name);
  if (!attribute) {
    if (input.required)
      throw InputError(
          element.place,
          fmt::format("<{} name=\"{}\"> has no {}", element.tag, element.name(), input.name),
          fmt::format("{}=\"...\": {}", input.name, input.meaning));
    return known_[name] = {Expr(input.otherwise), input.dimension};
  }
  if (!in_progress_.insert(name).second)
    throw InputError(attribute->place, fmt::format("'{}' is defined in a circle", name));
  Term term = quantity_or_expression(name, owner(element), *attribute, input.dimension);
  in_progress_.erase(name);
  return known_[name] = term;
}

std::vector<Expr> Compiler::inputs(const Element& element, const Declaration& declaration) {
  std::vector<Expr> values;
  for (const Input& i : declaration.inputs) values.push_back(input(element, i).value);
  return values;
}

std::vector<int> Compiler::choices(const Element& element, const Declaration& declaration) {
  std::vector<int> result;
  for (const Choice& choice : declaration.choices) {
    const Attribute* a = element.find(choice.name);
    int index = 0;
    if (a) {
      index = -1;
      for (std::size_t i = 0; i < choice.words.size(); ++i)
        if (choice.words[i] == a->text) index = static_cast<int>(i);
      if (index < 0)
        throw InputError(a->place, fmt::format("{}=\"{}\"", choice.name, a->text),
                         "one of: " + join(choice.words), nearest(a->text, choice.words));
    }
    result.push_back(index);
  }
  return result;
}

// constants, parameters, unknowns, sensors, and element.input
Term Compiler::resolve(const std::string& name, const Place& place) {
  if (auto it = known_.find(name); it != known_.end()) return it->second;
  if (const std::size_t dot = name.find('.'); dot != std::string::npos) {
    auto it = named_.find(name.substr(0, dot));
    const Plugin* plugin = it == named_.end() ? nullptr : registry_.find(it->second->tag);
    const Input* wanted = plugin ? plugin->declaration.find_input(name.substr(dot + 1)) : nullptr;
    if (wanted) {
      if (in_progress_.contains(name))
        throw InputError(place, fmt::format("'{}' is defined in a circle", name));
      return input(*it->second, *wanted);
    }
    std::vector<std::string> candidates;
    if (plugin)
      for (const Input& i : plugin->declaration.inputs)
        candidates.push_back(it->first + "." + i.name);
    else
      for (const auto& [n, e] : named_) candidates.push_back(n + name.substr(dot));
    throw InputError(place, fmt::format("no input '{}'", name),
                     plugin ? "one of: " + join(candidates) : "element.input",
                     nearest(name, candidates));
  }
  auto it = named_.find(name);
  if (it != named_.end()) {
    const Element& e = *it->second;
    const Attribute* value = e.find("value");
    if (!in_progress_.insert(name).second)
      throw InputError(place, fmt::format("'{}' is defined in a circle", name));
    if (e.tag == "constant" && value) {
      // A constant has the dimension its text has.
      known_[name] =
          parse_expression(value->text, value->place,
                           [this](const std::string& n, const Place& p) { return resolve(n, p); });
    } else if (e.tag == "parameter" && value) {
      known_[name] = quantity_or_expression(name, name, *value, kind(e));
    } else if (e.tag == "unknown") {
      unknown(e);
    } else if (registry_.find(e.tag, Family::sensor)) {
      sensor(e);
    }
    in_progress_.erase(name);
    if (auto known = known_.find(name); known != known_.end()) return known->second;
  }
  std::vector<std::string> candidates;
  for (const auto& [n, e] : named_)
    if (e->tag == "constant" || e->tag == "parameter" || e->tag == "unknown" ||
        registry_.find(e->tag, Family::sensor))
      candidates.push_back(n);
  throw InputError(
      place, fmt::format("'{}' is not a number, constant, parameter, unknown or sensor", name),
      candidates.empty() ? "one of these to be declared" : "one of: " + join(candidates),
      nearest(name, candidates));
}

void Compiler::sensor(const Element& element) {
  const Declaration& d = registry_.find(element.tag)->declaration;
  Reading reading{element.name(), element.text("column", element.name()), d.reading};
  reading.place = element.find("column") ? element.find("column")->place : element.place;
  if (const Attribute* a = element.find("sigma")) {
    reading.sigma = parse_quantity(a->text, d.reading, program_.units, a->place).value;
    if (reading.sigma < 0)
      throw InputError(a->place, fmt::format("sigma=\"{}\"", a->text), "zero or more");
  }
  if (const Attribute* a = element.find("range")) {
    const auto ends = split_list(*a);
    if (ends.size() != 2)
      throw InputError(a->place, fmt::format("range=\"{}\"", a->text), "two numbers: lower, upper");
    reading.range = {parse_quantity(ends[0].text, d.reading, program_.units, ends[0].place).value,
                     parse_quantity(ends[1].text, d.reading, program_.units, ends[1].place).value};
    if (!(reading.range->first < reading.range->second))
      throw InputError(a->place, fmt::format("range=\"{}\"", a->text), "lower below upper");
  }
  reading.slot = new_slot(reading.column);
  const Plugin& plugin = *registry_.find(element.tag);
  const std::vector<Expr> own = inputs(element, d);
  EffectPlace at{Acts::reading, element.name(), d.reading};
  at.around.reading = leaf(reading.slot);
  at.column = reading.column;
  at.joint = joint_of(element.name());
  for (std::size_t i = 0; i < own.size(); ++i) at.inputs[d.inputs[i].name] = own[i];
  const std::size_t index = program_.readings.size();  // circumstances of its effects follow it
  const Expr raw = leaf(reading.slot);
  program_.readings.push_back(std::move(reading));
  const Expr corrected = raw + corrections(at, {element.name(), at.joint, "measurement"})[0];
  const Expr value = plugin.value(corrected, own, choices(element, d));
  program_.readings[index].value = value;
  known_[element.name()] = {value, d.value};
}

void Compiler::unknown(const Element& element) {
  Unknown u{element.name(), kind(element)};
  u.place = element.place;
  u.start = parse_quantity(element.text("value", "0"), u.dimension, program_.units,
                           element.find("value") ? element.find("value")->place : element.place);
  if (const Attribute* per = element.find("per"); per && per->text != "pose")
    for (const Attribute& word : split_list(*per)) u.per.push_back(word.text);
  u.slot = new_slot(u.name);
  known_[u.name] = {leaf(u.slot), u.dimension};
  program_.unknowns.push_back(std::move(u));
}

}  // namespace talus
