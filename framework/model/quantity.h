// A number with a tolerance, as an attribute of a model file says it:
//
//     300                 fixed
//     300 ± 0.5           free, manufacturing tolerance (Gaussian prior) 0.5; ASCII: 300 +- 0.5
//     300 ?               free, no prior
//     1.5708 rad          with its own unit; without one the model's default unit holds
//     300 ± 0.5 mm [0, 310]   bounds; a unit after the last number holds for all that have none
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "framework/model/error.h"
#include "framework/model/units.h"

namespace talus {

struct Quantity {
  double value = 0;                                 // internal units, as are all numbers here
  bool free = false;                                // to be calibrated
  std::optional<double> tolerance;                  // standard deviation of the prior
  std::optional<std::pair<double, double>> bounds;  // lower, upper
};

// Does the text start like a quantity (a number), rather than like an expression of names?
bool looks_like_quantity(std::string_view text);

// Reads `text` as a quantity of `dimension`; throws InputError at `place` (column moved to the
// offending character) on a wrong unit, a malformed number, a negative tolerance, empty bounds, a
// value out of its bounds, or anything left over.
Quantity parse_quantity(std::string_view text, Dimension dimension, const UnitSystem& units,
                        const Place& place);

// The inverse, in the unit system's unit. Numbers are the shortest that read back the same, unless
// `digits` > 0 rounds them to that many significant digits of the tolerance.
std::string write_quantity(const Quantity& quantity, Dimension dimension, const UnitSystem& units,
                           int digits = 0);

// Shortest decimal text that reads back as the same double.
std::string shortest(double value);

}  // namespace talus
