// An effect's amounts as people speak of them: amplitude and phase instead of sine and cosine, size
// and direction instead of components, in the units of the field.
#pragma once

#include "framework/diagnosis/hypothesis.h"

namespace talus {

struct ShownValue {
  std::string name, unit;
  double value = 0, std = 0;  // in that unit; std is NaN for settings that were not fitted
};

std::vector<ShownValue> shown_values(const Accepted& effect, const UnitSystem& units);

}  // namespace talus
