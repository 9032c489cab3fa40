// The limit: a whole calibration on top of the SIMD floor, with nothing between it and the machine.
//
// Batches of [J r] are summed into their Gram matrix (39 x 39) while they are in the nearest cache,
// and Levenberg-Marquardt works on that matrix alone, damped like Ceres' (by its diagonal over a
// radius that starts at 1e4 and trebles). The sum knows that shifts leave the angles alone: 16 of
// the columns are zero in three of the six rows.
#pragma once

#include <Eigen/Core>

#include "tests/bench/isl_peer_simd.h"

namespace talus::bench {

using IslGram = Eigen::Matrix<double, IslSimd::columns, IslSimd::columns>;

// [J r]^T [J r] over all poses, at the parameters that were set.
IslGram isl_gram(const IslSimd& simd);

Calibration calibrate_limit(const IslPoses& poses, const IslFactors& factors);

}  // namespace talus::bench
