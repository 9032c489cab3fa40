// Where a curve of unknown physics acts: what it is a function of, of what it is a correction, and
// what the recordings say of it (curve_evidence.h), made linear where the fit with the curve ended.
#pragma once

#include <optional>

#include "framework/diagnosis/covariate_axes.h"
#include "framework/diagnosis/curve_evidence.h"
#include "framework/diagnosis/search.h"

namespace talus {

struct CurvePlace {
  CovariateAxis axis;
  int part = -1;  // of the correction
  CurveEvidence evidence;
  Dimension corrects;
};

// Of member i of the best hypothesis; none where it is no curve of one circumstance.
std::optional<CurvePlace> curve_place(const Ground& ground, const Search& search, std::size_t i,
                                      const UnitSystem& units);

// Is this parameter (a number of at.parameters) an amount of the accepted effect?
bool is_amount(const Linearised& at, std::size_t parameter, const Accepted& effect);

}  // namespace talus
