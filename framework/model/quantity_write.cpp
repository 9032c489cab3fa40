#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "framework/model/digits.h"
#include "framework/model/quantity.h"

namespace talus {
namespace {

double read(std::string_view text) {
  double value = 0;
  read_digits(text, value);
  return value;
}

// Both to `digits` significant digits of the tolerance, e.g. "300.00" and "0.50".
std::pair<std::string, std::string> round_to_tolerance(double value, double tolerance, int digits) {
  const std::string scientific = fmt::format("{:.{}e}", tolerance, digits - 1);
  const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
  const int decimals = digits - 1 - exponent;
  if (decimals > 15) return {shortest(value), shortest(tolerance)};
  if (decimals >= 0)
    return {fmt::format("{:.{}f}", value + 0.0, decimals),
            fmt::format("{:.{}f}", tolerance, decimals)};
  const double step = std::pow(10.0, -decimals);
  return {shortest(std::round(value / step) * step), shortest(std::round(tolerance / step) * step)};
}

}  // namespace

std::string write_quantity(const Quantity& quantity, Dimension dimension, const UnitSystem& units,
                           int digits) {
  const Unit unit = units.of(dimension);
  const Unit difference{unit.text, unit.dimension, unit.factor};
  const bool has_tolerance = quantity.free && quantity.tolerance && *quantity.tolerance > 0;
  std::string value = shortest(quantity.value, unit), tolerance;
  if (has_tolerance) tolerance = shortest(*quantity.tolerance, difference);
  if (has_tolerance && digits > 0) {
    const auto rounded = round_to_tolerance((quantity.value - unit.offset) / unit.factor,
                                            *quantity.tolerance / unit.factor, digits);
    const double back = unit.factor * read(rounded.first) + unit.offset;
    const auto& bounds = quantity.bounds;
    if (!bounds || (bounds->first <= back && back <= bounds->second)) value = rounded.first;
    tolerance = rounded.second;
  }
  const bool has_default_unit = dimension == number || dimension == length || dimension == angle;
  std::string text = value;
  if (has_tolerance) text += " ± " + tolerance;
  if (!has_default_unit) text += " " + unit.text;
  if (quantity.free && !has_tolerance) text += " ?";
  if (quantity.bounds)
    text += " [" + shortest(quantity.bounds->first, unit) + ", " +
            shortest(quantity.bounds->second, unit) + "]";
  return text;
}

std::string shortest(double value) { return fmt::format("{}", value + 0.0); }  // no "-0"

std::string shortest(double value, const Unit& unit) {
  const double written = (value - unit.offset) / unit.factor;
  auto reads_back = [&](double x) { return unit.factor * x + unit.offset == value; };
  for (int digits : {15, 16}) {
    const double rounded = read(write_digits(written, digits));
    if (reads_back(rounded)) return shortest(rounded);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  for (double x : {written, std::nextafter(written, -infinity), std::nextafter(written, infinity)})
    if (reads_back(x)) return shortest(x);
  return shortest(written);
}

}  // namespace talus
