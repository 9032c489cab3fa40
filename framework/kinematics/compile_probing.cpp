#include <fmt/format.h>

#include <algorithm>

#include "framework/kinematics/compiler.h"

namespace talus {
namespace {

template <class Things>
int index_of(const Things& things, const std::string& name) {
  for (std::size_t i = 0; i < things.size(); ++i)
    if (things[i].name == name) return static_cast<int>(i);
  return -1;
}

template <class Things>
void add_names(const Things& things, std::vector<std::string>& names) {
  for (const auto& thing : things) names.push_back(thing.name);
}

// "a, b; c" in words with places.
std::vector<Attribute> split_at(const Attribute& attribute, char separator) {
  std::vector<Attribute> words;
  for (std::size_t start = 0; start <= attribute.text.size();) {
    const std::size_t end = std::min(attribute.text.find(separator, start), attribute.text.size());
    Place place = attribute.place;
    if (place.column > 0) place.column += static_cast<int>(start);
    words.push_back({attribute.name, attribute.text.substr(start, end - start), place});
    start = end + 1;
  }
  return words;
}

std::string trimmed(std::string text) {
  text.erase(0, text.find_first_not_of(' '));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

int Compiler::find_shape(const Attribute& word) const {
  const int found = index_of(program_.shapes, word.text);
  if (found >= 0) return found;
  std::vector<std::string> names;
  add_names(program_.shapes, names);
  throw InputError(word.place, fmt::format("no probed shape '{}' above this", word.text),
                   names.empty() ? "shapes such as <plane name=\"face\"/> to stand before it"
                                 : "one of: " + join(names),
                   nearest(word.text, names));
}

void Compiler::shape(const Element& element) {
  const Plugin& plugin = *registry_.find(element.tag, Family::shape);
  ProbedShape s{element.name(), element.tag, plugin.declaration, plugin.deviations};
  s.place = element.place;
  if (const Attribute* on = element.find("on")) {
    s.on = find_shape(*on);
    if (program_.shapes[s.on].declaration.sense != Sense::around)
      throw InputError(on->place, fmt::format("'{}' is a {}", on->text, program_.shapes[s.on].tag),
                       "a plane or a circle to project the points on");
  }
  if (const Attribute* through = element.find("through"))
    for (const Attribute& word : split_list(*through)) s.through.push_back(find_shape(word));
  auto positive = [&](const char* attribute, std::optional<double>& target) {
    const Attribute* a = element.find(attribute);
    if (!a) return;
    target = parse_quantity(a->text, length, program_.units, a->place).value;
    if (!(*target > 0))
      throw InputError(a->place, fmt::format("{}=\"{}\"", attribute, a->text), "more than zero");
  };
  positive("radius", s.radius);
  positive("sigma", s.sigma);
  if (const Attribute* at = element.find("at")) s.frame = program_.frame(at->text, at->place);
  if (const Attribute* probe = element.find("probe")) {
    if (s.frame < 0)
      throw InputError(probe->place, fmt::format("'{}' has points but no frame", s.name),
                       "at=\"...\": the frame in which the points are given");
    for (const Attribute& point : split_at(*probe, ';')) {
      const auto words = split_list(point);
      if (words.size() != 3)
        throw InputError(point.place, fmt::format("the point '{}'", trimmed(point.text)),
                         "three lengths: x, y, z; the next point behind a ';'");
      Vector3<double> p;
      for (int i = 0; i < 3; ++i)
        p[i] = parse_quantity(words[i].text, length, program_.units, words[i].place).value;
      s.probe.push_back(p);
    }
  }
  program_.shapes.push_back(std::move(s));
}

void Compiler::datum(const Element& element) {
  Datum d{element.name()};
  d.place = element.place;
  for (const Attribute& word : split_list(*element.find("origin")))
    d.origin.push_back(find_shape(word));
  for (const char* attribute : {"primary", "secondary", "check"}) {
    const Attribute* a = element.find(attribute);
    if (!a) continue;
    const std::string text = trimmed(a->text);
    const std::size_t equals = text.find('=');
    Datum::Axis axis;
    axis.axis = text.empty() ? 3 : text[0] - 'x';
    if (equals == std::string::npos || trimmed(text.substr(0, equals)).size() != 1 ||
        axis.axis < 0 || axis.axis > 2)
      throw InputError(a->place, fmt::format("{}=\"{}\"", attribute, a->text),
                       "an axis and the shape it follows: y=face, or y=-face");
    std::string shape = trimmed(text.substr(equals + 1));
    axis.reversed = shape.starts_with('-');
    if (axis.reversed) shape = trimmed(shape.substr(1));
    axis.shape = find_shape({a->name, shape, a->place});
    if (program_.shapes[axis.shape].declaration.sense == Sense::none)
      throw InputError(
          a->place,
          fmt::format("'{}' is a {}, which has no axis", shape, program_.shapes[axis.shape].tag),
          "a plane, line, circle or cylinder");
    for (const Datum::Axis& other : d.axes) {
      if (other.shape == axis.shape)
        throw InputError(a->place, fmt::format("'{}' gives an axis already", shape),
                         "another shape");
      if (other.axis == axis.axis)
        throw InputError(a->place, fmt::format("a second shape for the axis {}", text[0]),
                         "another axis");
    }
    d.axes.push_back(axis);
  }
  if (element.find("check") && !element.find("secondary"))
    throw InputError(element.find("check")->place, "an axis to check, but no secondary axis",
                     "secondary=\"...\", then check=\"...\"");
  if (const Attribute* a = element.find("square")) {
    d.square = parse_quantity(a->text, angle, program_.units, a->place).value;
    if (!(*d.square > 0))
      throw InputError(a->place, fmt::format("square=\"{}\"", a->text), "more than zero");
  }
  program_.datums.push_back(std::move(d));
}

// probed="E_datum in B_datum"
Probed Compiler::probed(const Element& element, Kind kind) const {
  Probed result;
  const Attribute* a = element.find("probed");
  if (!a) return result;
  std::vector<std::string> datums, all;
  add_names(program_.datums, datums);
  all = datums;
  add_names(program_.shapes, all);
  const std::size_t in = a->text.find(" in ");
  const std::string what = trimmed(a->text.substr(0, in));
  if (in != std::string::npos) {
    const std::string where = trimmed(a->text.substr(in + 4));
    result.in = index_of(program_.datums, where);
    if (result.in < 0)
      throw InputError(a->place, fmt::format("no datum '{}'", where),
                       datums.empty() ? "<datum name=\"...\" .../>" : "one of: " + join(datums),
                       nearest(where, datums));
  }
  result.datum = index_of(program_.datums, what);
  if (result.datum < 0) result.shape = index_of(program_.shapes, what);
  if (!result)
    throw InputError(a->place, fmt::format("no datum or probed shape '{}'", what),
                     all.empty() ? "<datum name=\"...\" .../> or a shape such as <sphere .../>"
                                 : "one of: " + join(all),
                     nearest(what, all));
  if (kind == Kind::frame && result.datum < 0)
    throw InputError(a->place, fmt::format("'{}' is a {}", what, program_.shapes[result.shape].tag),
                     "a datum: a frame is measured");
  // A datum with one axis may turn about it as it likes: it has an origin and that axis.
  auto whole = [&](int datum, const char* expected) {
    if (datum >= 0 && program_.datums[datum].axes.size() < 2)
      throw InputError(a->place,
                       fmt::format("the datum '{}' has one axis only", program_.datums[datum].name),
                       expected);
  };
  if (kind == Kind::frame)
    whole(result.datum, "a datum with primary and secondary axes: a frame is measured");
  if (kind == Kind::direction && result.datum >= 0 &&
      program_.datums[result.datum].axes[0].axis != 2)
    whole(result.datum, "a datum with a secondary axis, or primary=\"z=...\": its z is measured");
  if (kind != Kind::scalar)
    whole(result.in, "a datum with primary and secondary axes to measure in");
  if (kind == Kind::direction && result.shape >= 0 &&
      program_.shapes[result.shape].declaration.sense == Sense::none)
    throw InputError(a->place,
                     fmt::format("'{}' is a {}, which has no direction", what,
                                 program_.shapes[result.shape].tag),
                     "a datum, plane, line, circle or cylinder");
  if (kind == Kind::nothing)
    throw InputError(a->place, "nothing of a closure is measured", "no attribute 'probed'");
  return result;
}

}  // namespace talus
