#include <fmt/format.h>

#include <cmath>

#include "framework/kinematics/compiler.h"

namespace talus {
namespace {

constexpr const char* components[] = {"x", "y", "z"};

std::string shown(const Attribute& a) { return fmt::format("{}=\"{}\"", a.name, a.text); }

}  // namespace

double Compiler::fixed_mass(const Attribute& attribute) {
  const double value = fixed(attribute, mass, "a mass that is not calibrated, such as 0.18 kg");
  if (value < 0) throw InputError(attribute.place, shown(attribute), "zero or more");
  return value;
}

// The link behind a joint: mass="0.18 kg" com="0, 0, 20".
void Compiler::link(const Element& joint) {
  const Attribute *m = joint.find("mass"), *com = joint.find("com");
  if (!m && com)
    throw InputError(
        com->place,
        fmt::format("<{} name=\"{}\"> has a centre of mass, but no mass", joint.tag, joint.name()),
        "mass=\"...\": mass of the link behind the joint, such as 0.18 kg");
  if (!m) return;
  Link link{program_.frame(joint.name(), joint.place), fixed_mass(*m), {}, m->place};
  if (com) {
    const auto words = split_list(*com);
    if (words.size() != 3)
      throw InputError(com->place, shown(*com), "three lengths: x, y, z in the frame behind it");
    for (int i = 0; i < 3; ++i)
      link.com[i] = fixed(words[i], length, "a length that is not calibrated, such as 20 mm");
  }
  program_.links.push_back(std::move(link));
}

void Compiler::gravity(const Element& element) {
  if (program_.gravity)
    throw InputError(
        element.place,
        fmt::format("gravity is given twice (before at {})", to_string(program_.gravity->place)),
        "one <gravity>");
  Gravity gravity;
  gravity.place = element.place;
  if (const Attribute* in = element.find("in")) gravity.frame = program_.frame(in->text, in->place);
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const Attribute* a = element.find(components[i]);
    gravity.direction[i] = a ? fixed(*a, number, "a number that is not calibrated, such as -1") : 0;
    square += gravity.direction[i] * gravity.direction[i];
  }
  if (!(square > 0))
    throw InputError(element.place, "gravity has no direction",
                     "components of a vector that points down, such as z=\"-1\"");
  for (double& component : gravity.direction) component /= std::sqrt(square);
  gravity.magnitude = 9810;
  if (const Attribute* a = element.find("magnitude")) {
    gravity.magnitude = fixed(*a, length / (duration * duration),
                              "an acceleration that is not calibrated, such as 9.81 m/s^2");
    if (!(gravity.magnitude > 0)) throw InputError(a->place, shown(*a), "more than zero");
  }
  if (const Attribute* a = element.find("held_at")) {
    gravity.held_at = program_.frame(a->text, a->place);
    if (gravity.held_at == 0)
      throw InputError(a->place, fmt::format("'{}' is the root, which stands anyway", a->text),
                       "the frame at the other end that something holds");
  }
  program_.gravity = gravity;
}

void Compiler::payload(const Element& element) {
  Payload payload;
  payload.place = element.place;
  const Attribute *at = element.find("at"), *column = element.find("column"),
                  *m = element.find("mass");
  payload.frame = program_.frame(at->text, at->place);
  if (!column == !m)
    throw InputError(element.place,
                     fmt::format("a payload at '{}' {}", at->text,
                                 m ? "with both a column and a mass" : "of no mass"),
                     "either column=\"...\", a column of the recordings, or mass=\"2 kg\"");
  if (column) payload.column = column->text;
  if (m) payload.mass = fixed_mass(*m);
  if (const Attribute* a = element.find("range")) {  // for whoever proposes poses
    const auto ends = split_list(*a);
    if (m || ends.size() != 2)
      throw InputError(a->place, shown(*a), "two masses of a payload with a column: 0, 5 kg");
    if (!(fixed_mass(ends[0]) < fixed_mass(ends[1])))
      throw InputError(a->place, shown(*a), "lower below upper");
  }
  program_.payloads.push_back(std::move(payload));
}

}  // namespace talus
