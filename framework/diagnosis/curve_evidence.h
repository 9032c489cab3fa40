// What recordings say of a correction as a function phi of one circumstance x, modulo what the
// geometry can take up. With f_k the whitened column of a constant correction of pose k, F all of
// them, Q a basis of the geometry's columns and w the projected rows, a correction phi(x_k) has
//     the Gram matrix phi^T K phi, K = diag(f_k^T f_k) - B^T B, B = Q^T F,
//     and the right side phi^T g, g = -F^T w:
// that is all that is needed to fit any function of x.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "framework/model/units.h"

namespace talus {

struct CurveEvidence {
  Dimension of;                         // the circumstance
  Eigen::VectorXd x;                    // of each pose (or cell of poses)
  Eigen::VectorXd weight, wanted;       // f^T f, g
  Eigen::MatrixXd absorbed;             // B: directions of the geometry x poses
  std::vector<Eigen::MatrixXd> curves;  // free curves: values of their pieces at the poses
  double typical = 1;                   // usual size of the correction
  double chi2 = 0, freedom = 0;         // of the rows without any correction
  double rows = 0;
  bool noise_known = true;
};

// Many poses are put into cells of nearly equal circumstance.
CurveEvidence in_cells(const CurveEvidence& evidence, int most);

Eigen::MatrixXd weighed(const CurveEvidence& evidence, const Eigen::MatrixXd& phi);  // K phi

// The chi-square that a free curve explains (beside a formula's functions, where some are given),
// and how many directions of it are seen. Its heights are loosely held to zero, as in a fit.
std::pair<double, int> curve_gain(const CurveEvidence& evidence, const Eigen::MatrixXd& curve,
                                  const Eigen::MatrixXd* beside = nullptr);

}  // namespace talus
