// What a finding corrects, seen in the residuals: per pose the correction u that the pose asks for
// at the finding's place,
//     u_k = -f_k^T w_k / (f_k^T f_k),    f_k the whitened columns of a constant correction there,
// against the circumstance that it depends on (a reading, the approach, the time, a load), averaged
// over bins with the weights f_k^T f_k. `before` is of the best fit without the finding (the others
// kept), `after` of the fit with it, `fitted` their difference: what the effect took away. The
// geometry was refitted both times, so that a curve is what geometry could not take up; a constant
// and a slope are usually missing from it. `fitted` moves with the noise as the effect's amounts
// do, those of the geometry taken out: less than the bins, whose every pose has noise of its own.
#pragma once

#include <string>
#include <vector>

#include "framework/diagnosis/diagnosis.h"

namespace talus {

struct CurvePoint {
  double x = 0, before = 0, after = 0, fitted = 0;
  double std = 0;         // of before and after, by the noise
  double fitted_std = 0;  // of fitted
  int count = 0;
};

struct Curve {
  std::string x, x_unit, y, y_unit;   // "encoder3", "deg"; "correction of encoder3", "deg"
  std::vector<CurvePoint> points;     // by x; none where nothing varies
  std::vector<CurvePoint> fine = {};  // the same in more bins, of equal counts: for a picture
};

// Of member i of the best hypothesis.
Curve curve_of(const Ground& ground, const Search& search, std::size_t i, const UnitSystem& units);

}  // namespace talus
