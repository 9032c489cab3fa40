#include <cmath>
#include <filesystem>
#include <fstream>

#include "framework/report/report.h"

namespace talus {
namespace {

// The owner of a parameter as the compiler calls it: a name, for a <calibrate> its number, for an
// effect without a name its tag and place.
Element* find_owner(Element& root, const std::string& owner) {
  int number = 0;
  for (Element& child : root.children)
    if (child.tag == "calibrate" && ++number &&
        owner == "calibrate" + (number == 1 ? "" : std::to_string(number)))
      return &child;
  if (Element* named = root.find_named(owner)) return named;
  for (Element& child : root.children)
    if (child.name().empty() &&
        owner == child.tag + (child.find("at") ? "_" + child.text("at") : ""))
      return &child;
  return nullptr;
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
  std::error_code error;
  if (const auto status = std::filesystem::status(file, error);
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    std::ofstream out(file, std::ios::binary);  // a device or a pipe: nothing to rename over
    out << text;
    out.flush();
    if (!out) throw InputError({file, 0, 0}, "cannot be written");
    return;
  }
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
  std::filesystem::rename(beside, file, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw InputError({file, 0, 0}, "cannot be written: " + error.message());
  }
}

}  // namespace talus
