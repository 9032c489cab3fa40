#include <cmath>
#include <filesystem>
#include <fstream>

#include "framework/report/report.h"

namespace talus {
namespace {

Element* find_named(Element& element, const std::string& name) {
  for (Element& child : element.children) {
    if (child.name() == name) return &child;
    if (Element* found = find_named(child, name)) return found;
  }
  return nullptr;
}

// The owner of a parameter as the compiler calls it: a name, or for a <calibrate> its number.
Element* find_owner(Element& root, const std::string& owner) {
  int number = 0;
  for (Element& child : root.children)
    if (child.tag == "calibrate" && ++number && owner == "calibrate" + (number == 1 ? "" : std::to_string(number))) return &child;
  return find_named(root, owner);
}

}  // namespace

Model calibrated_model(const Model& model, const Program& program, const Fit& fit) {
  Model result = model;
  for (std::size_t i = 0; i < program.parameters.size(); ++i) {
    const Parameter& p = program.parameters[i];
    const FittedValue& v = fit.parameters[i];
    Quantity q = p.nominal;
    q.value = v.value;
    if (std::isfinite(v.std) && v.std > 0) q.tolerance = v.std;
    if (Element* element = find_owner(result.root, p.element))
      element->set(p.attribute, write_quantity(q, p.dimension, program.units, 4));
  }
  return result;
}

void write_file(const std::string& file, const std::string& text) {
  const std::string beside = file + ".part";
  {
    std::ofstream out(beside, std::ios::binary);
    out << text;
    out.flush();
    if (!out) {
      std::error_code ignored;
      std::filesystem::remove(beside, ignored);
      throw InputError({file, 0, 0}, "cannot be written");
    }
  }
  std::error_code error;
  std::filesystem::rename(beside, file, error);
  if (error) throw InputError({file, 0, 0}, "cannot be written: " + error.message());
}

}  // namespace talus
