// A state of a linkage as the page's JSON: slots, poses, residuals, and how far each measured
// feature is from where it is modelled, pose by pose.
#pragma once

#include <nlohmann/json.hpp>

#include "framework/calibration/fit.h"
#include "framework/page/page.h"

namespace talus {

nlohmann::ordered_json json_of(const PageState& state);

// Numbers with so many significant digits; null where there is none.
nlohmann::ordered_json rounded(double value, int digits);

// The poses and residuals of a fit, or of a model as it stands (x: parameters, then shared).
PageState fitted_state(std::string label, const Program& program, const Recordings& recordings,
                       const Fit& fit);
PageState given_state(std::string label, const Program& program, const Recordings& recordings,
                      int threads);

}  // namespace talus
