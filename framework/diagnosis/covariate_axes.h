// The circumstances that an effect depends on, as axes that its correction is shown against: a
// reading, a coordinate, the time, the components of a load.
#pragma once

#include "framework/diagnosis/stage.h"

namespace talus {

struct CovariateAxis {
  std::string name, unit;
  double factor = 1;  // internal units of one
  Expr value;
  Dimension dimension;
};

std::vector<CovariateAxis> covariate_axes(const Accepted& effect, const EffectPlace& place,
                                          const Program& program, const UnitSystem& units);

// Of each pose.
Eigen::VectorXd values_at(const Linearised& at, const Expr& expression);

// The effect among those that the linearised model suspects; null where it is not.
const Suspect* suspect_of(const Linearised& at, const Accepted& effect);

}  // namespace talus
