// How sure a fit is of its parameters, together: what is needed to say how sure it is of anything
// that is made from them.
//
// With J the whitened Jacobian (latent unknowns projected out), P the tolerances' covariance and
// C = (J^T J + P^-1)^-1,
//     stated:    C, right where the noise is as stated;
//     observed:  C (f sum_k g_k g_k^T + P^-1) C, g_k the gradient of pose k: the spread of the
//                residuals from pose to pose as it is, whatever was stated and however the errors
//                of one pose hang together; f makes up for the freedom that the fit has used.
// Both take poses as independent. A direction that neither the recordings nor a tolerance holds is
// listed apart.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "framework/calibration/fit.h"

namespace talus {

struct Covariance {
  Eigen::MatrixXd stated, observed;  // of x
  Eigen::MatrixXd unbounded;         // columns: directions of x with nothing to hold them
  std::vector<double> latent_std;    // per latent unknown: root mean square over the poses
};

// Not for unknowns shared by groups of rows.
Covariance covariance(const Program& program, const Recordings& recordings, const Split& split,
                      const Fit& fit);

}  // namespace talus
