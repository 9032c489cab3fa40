// Small words for tests of whole calibrations.
#pragma once

#include <string>

#include "framework/calibration/fit.h"
#include "tests/support/models.h"

namespace talus::testing {

inline Split all_to_fit(const Recordings& recordings) {
  Split split;
  split.fit = all_rows(recordings);
  return split;
}

inline Split random_split(const Recordings& recordings, std::uint64_t seed) {
  SplitOptions options;
  options.seed = seed;
  return split_rows(recordings, options);
}

inline const FittedValue& value(const Fit& fit, const std::string& name) {
  for (const FittedValue& v : fit.parameters)
    if (v.name == name) return v;
  throw InputError("no parameter " + name);
}

inline bool warns(const Fit& fit, const std::string& of) {
  for (const std::string& w : fit.warnings)
    if (w.find(of) != std::string::npos) return true;
  return false;
}

}  // namespace talus::testing
