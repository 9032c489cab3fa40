// A number with a tolerance, as an attribute of a model file says it:
//
//     300                 fixed
//     300 ± 0.5           free, manufacturing tolerance (Gaussian prior) 0.5; ASCII: 300 +- 0.5
//     300 ?               free, no prior
//     1.5708 rad          with its own unit; without one the model's default unit holds
//     300 ± 0.5 mm [0, 310]   bounds (inf and -inf for none on one side); a unit after a later
//                             number holds for the earlier ones that have none, and the value's
//                             own unit for the later ones
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

// Is the text meant as a quantity ("300 mm", "0 ?", and misspelt ones such as "300,5" or "3 mmm"),
// rather than as an expression ("2*L", "90 deg + encoder1", "encoder1")?
bool looks_like_quantity(std::string_view text);

// Reads `text` as a quantity of `dimension`; throws InputError at `place`, that of the text's first
// character, with the column moved to the offending character (not byte), on a wrong unit, a
// malformed number, a tolerance that is not positive, empty bounds, a value out of its bounds, or
// anything left over.
Quantity parse_quantity(std::string_view text, Dimension dimension, const UnitSystem& units,
                        const Place& place);

// The inverse, in the unit system's unit. Numbers are the shortest that read back the same, unless
// `digits` > 0 rounds them to that many significant digits of the tolerance.
std::string write_quantity(const Quantity& quantity, Dimension dimension, const UnitSystem& units,
                           int digits = 0);

// Shortest decimal text that reads back as the same double.
std::string shortest(double value);

// Shortest text of an internal `value` in `unit`, without the unit, that reads back as the same
// double; where no number in that unit does, as a neighbour of it.
std::string shortest(double value, const Unit& unit);

}  // namespace talus
