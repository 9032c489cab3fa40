// One source of noise that is noisier than the others, by the score of its share.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "framework/calibration/problem.h"
#include "framework/diagnosis/noise.h"

namespace talus {

// rows[pose]: rows whose covariance is the sum of the pose's shares, times gamma each. The source
// (or several of one measurement and dimension together) that is noisier, if any is beyond doubt.
std::optional<NoiseVerdict::Source> noisier_source(const Problem::Noise& noise,
                                                   const std::vector<Eigen::VectorXd>& rows);

}  // namespace talus
