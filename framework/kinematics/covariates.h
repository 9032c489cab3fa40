// Circumstances that follow from the recordings: columns that effects need and that nobody records.
//
//     rate:<column>     difference quotient by the time, from the parabola through the neighbouring
//                       rows of its session; 0 where the neighbours are more than 1 s away: a
//                       linkage recorded pose by pose is at rest
//     travel:<column>   how far it went since its sense last changed (or its session began)
//     since             time since the session began
//     pose              number of the row, where none was recorded
#pragma once

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// Adds those of these columns that the program needs and the recordings lack.
Recordings with_covariates(const Program& program, Recordings recordings);

}  // namespace talus
