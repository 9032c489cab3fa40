// Is what a fit has left over noise, and is it the noise that was stated?
//
// With d_k^2 the deletion residuals of the poses (outliers.h), chi-square distributed with f_k
// degrees of freedom where the stated noise is right:
//   * scale: sqrt(chi-square / degrees of freedom), 1 as stated;
//   * tails: d_k^4 has the mean f_k (f_k + 2) for Gaussian noise (Mardia); where it is larger,
//     tails are heavy, as of Student's t with so many degrees of freedom;
//   * white: neighbours in the order of recording, in every reading and coordinate and in every
//     column but the measured ones (whose errors are in the order itself) do not resemble each
//     other, neither in their rows as a whole nor in what these say of the error of any one reading
//     or measured row; where they do, something was left out or the noise is correlated;
//   * even: the size of the misfit does not depend on any of these either;
//   * sources: the covariance of the rows is a sum over readings and measured rows,
//     C_k = sum_g gamma_g V_gk with gamma = 1 as stated. One source that is noisier than the others
//     is found by its score and estimated by maximum likelihood.
// Physics is to be looked for first: over few poses, or spread over many coordinates, it can look
// like white noise. Tails and sizes are judged only of what is white.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/diagnosis/faults.h"

namespace talus {

struct NoiseVerdict {
  double scale = 1;  // of the noise, over the stated one; 1 where none is stated
  double p = 1;      // that chi-square is as large (or, where scale < 1, as small) by chance
  bool larger = false, smaller = false;  // than stated, beyond doubt; of white residuals
  double kurtosis = 3;                   // 3: Gaussian
  bool heavy = false;
  std::optional<double> student;  // degrees of freedom of tails as heavy
  double p_white = 1;             // the least white order of all, their number taken into account
  std::string unwhite;            // in which order, where it is beyond doubt
  std::string channel;  // and in which sensor's or measure's error; empty: in the rows as a whole
  double correlation = 0;  // of neighbours in the order of recording
  double p_order = 1;      // that they are as much alike by chance
  double p_even = 1;
  std::string uneven;
  struct Source {
    std::string name;  // of a sensor or a measure
    double ratio = 1;  // over its stated noise
    double rest = 1;   // the others'
    double p = 1;
  };
  std::optional<Source> source;
  std::string statement;      // always said
  std::vector<Fault> faults;  // what is wrong beyond doubt
};

// rows: those fitted, without blunders; x: the fit to them.
NoiseVerdict judge_noise(const Program& program, const Recordings& recordings,
                         const std::vector<std::size_t>& rows, std::span<const double> x,
                         const FaultOptions& options = {});

}  // namespace talus
