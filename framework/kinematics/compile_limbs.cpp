#include <fmt/format.h>

#include "framework/kinematics/compiler.h"

namespace talus {

namespace {

const char* const a_length = "a length that is not calibrated, such as 60 mm";

}

// A number that nothing changes: written as such, or as an expression of constants.
double Compiler::fixed(const Attribute& attribute, Dimension dimension,
                       const std::string& expected) {
  if (looks_like_quantity(attribute.text) &&
      attribute.text.find_first_of("*/^(") == std::string::npos) {
    const Quantity q = parse_quantity(attribute.text, dimension, program_.units, attribute.place);
    if (q.free)
      throw InputError(attribute.place,
                       fmt::format("{}=\"{}\" is free", attribute.name, attribute.text), expected);
    return q.value;
  }
  const Term term = parse_expression(
      attribute.text, attribute.place,
      [this](const std::string& name, const Place& place) { return resolve(name, place); });
  if (!(term.dimension == dimension))
    throw InputError(
        attribute.place,
        fmt::format("{}=\"{}\" is {}", attribute.name, attribute.text, describe(term.dimension)),
        describe(dimension));
  if (!term.value.is_constant())
    throw InputError(attribute.place,
                     fmt::format("{}=\"{}\" is no fixed number", attribute.name, attribute.text),
                     expected);
  return term.value.constant();
}

void Compiler::limb(const Element& element) {
  Limb limb{element.name()};
  limb.place = element.place;
  const Attribute* at = element.find(element.find("at") ? "at" : "name");
  limb.frame = program_.frame(at->text, at->place);
  const char* edges[] = {"length", "width", "height"};
  const char* centre[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Attribute& edge = *element.find(edges[i]);
    limb.size[i] = fixed(edge, length, a_length);
    if (!(limb.size[i] > 0))
      throw InputError(edge.place, fmt::format("{}=\"{}\"", edge.name, edge.text),
                       "more than zero");
    const Attribute* a = element.find(centre[i]);
    limb.centre[i] = a ? fixed(*a, length, a_length) : 0;
  }
  program_.limbs.push_back(std::move(limb));
}

}  // namespace talus
