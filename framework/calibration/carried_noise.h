// The covariance of measured columns whose noise is carried to the rows: what was worked out from
// points, and frames and directions with a residual that makes more rows of them than they have
// degrees of freedom (the three inverse direction cosines of an axis).
//
// Of an instrument with a position noise s_p along each axis and an orientation noise s_r about
// each axis, a position has s_p^2 I, a quaternion q has s_r^2 / 4 (|q|^2 I - q q^T), and a
// direction u has s_r^2 (|u|^2 I - u u^T).
#pragma once

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

// Without any column where no feature is of that kind: what the points say stands in `recordings`.
MeasuredNoise carried_noise(const Program& program, const Recordings& recordings);

}  // namespace talus
