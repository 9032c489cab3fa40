// Circumstances that follow from the recordings: columns that effects need and that nobody records.
//
//     rate:<column>     difference quotient by the time, from the parabola through the neighbouring
//                       rows of its session; 0 where the neighbours are more than 1 s away: a
//                       linkage recorded pose by pose is at rest
//     travel:<column>   how far it went since its sense last changed (or its session began)
//     since             time since the session began
//     pose              number of the row, where none was recorded
#pragma once

#include <string_view>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// Adds those of these columns that the program needs and the recordings lack.
Recordings with_covariates(const Program& program, Recordings recordings);

// Does a column follow from others? Static loads (calibration/load_columns.h) do as well.
bool is_derived(std::string_view column);

// The value of a covariate of which nothing is known: 20 degC, session 1, pose 1, otherwise zero.
double usual_value(std::string_view covariate);

}  // namespace talus
