// What the recordings see of the parameters, and what they do not.
//
// In coordinates scaled by each parameter's tolerance (or, where it has none, by a size typical of
// its dimension), the singular values of the whitened Jacobian say by how many sigmas, over all
// recordings together, a move of one tolerance shows. A direction with less than one sigma is
// unseen: the threshold comes from the noise. Unseen directions keep their tolerance and are put
// into words.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "framework/calibration/problem.h"

namespace talus {

struct Identifiability {
  Eigen::VectorXd
      std;  // standard uncertainty of x with priors; infinite where unseen and without prior
  std::vector<bool> identifiable;   // per entry of x
  std::vector<std::string> unseen;  // one sentence per unseen direction
  Eigen::MatrixXd directions;       // the unseen directions, columns, in units of x (sparse basis)
  int seen = 0;                     // number of directions seen
  double effective = 0;             // parameters' worth of information drawn from the recordings
  Eigen::VectorXd singular;         // singular values, decreasing, in sigmas per tolerance
  // Observability indices of the seen directions (Sun & Hollerbach 2008): O1 mean product, O2
  // inverse condition, O3 least singular value, O4 noise amplification, O5 harmonic mean.
  double o1 = 0, o2 = 0, o3 = 0, o4 = 0, o5 = 0;
};

// `noise_scale` multiplies the stated noise (1 where it is known).
Identifiability identify(Problem& problem, std::span<const double> x, double noise_scale,
                         const UnitSystem& units);

// The size a parameter is measured by where it has no tolerance: 10 mm, 10 deg, 0.1, ...
double typical_size(const Quantity& quantity, Dimension dimension);

}  // namespace talus
