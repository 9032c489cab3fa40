// A calibration from start to end: split rows, fit, judge on the rows held out, say what was seen
// and what not. Plain data in, plain data out.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/calibration/identifiability.h"
#include "framework/calibration/solve.h"
#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct FitOptions {
  int threads = 1;
  int max_iterations = 400;
  int restarts = 4;  // from starts scattered over the tolerances
  std::uint64_t seed = 1;
  std::vector<double> start;  // instead of the nominal values; parameters, then shared unknowns
  enum class Solver { automatic, gram, qr } solver = Solver::automatic;
  std::function<void(double)> progress;  // share of the starts done
};

// The errors of one residual row over some poses, in internal units; NaN where not defined.
struct Measure {
  std::string name;
  Dimension dimension;
  std::size_t count = 0;
  double bias = 0, precision = 0, rmse = 0;  // mean, standard deviation, root mean square
  double fsr = 0, percent_fsr = 0;  // full-scale range over all recordings, rmse as a share of it
};

struct FittedValue {
  std::string name;
  Dimension dimension;
  double nominal = 0, value = 0, std = 0;  // std infinite where unseen and without tolerance
  std::optional<double> tolerance;
  bool identifiable = true;
  bool at_bound = false;
  bool held_out =
      false;  // of a group that has held-out rows only: found for judging, not a result of the fit
};

struct Fit {
  std::vector<FittedValue> parameters;  // in the order of Program::parameters
  std::vector<FittedValue> shared;      // instances of group unknowns
  std::vector<double> x;  // parameters, then shared: the solution as the solver has it
  std::size_t poses_fit = 0, poses_check = 0, rows_fit = 0, rows_missing = 0;
  std::vector<Measure> measures_fit, measures_check;
  double fit_rms = 0,
         heldout_rms = 0;   // of rows divided by their sigmas (or by the estimated noise)
  double expected_rms = 1;  // of rows explained by the instruments: below 1 where unknowns of each
                            // pose take their share
  bool noise_known = true;
  double chi2 = 0, dof = 0, chi2_p = 1, noise_scale = 1;  // estimated / stated noise
  Identifiability seen;
  int iterations = 0;
  bool converged = false;
  double seconds = 0, cost = 0;
  std::string stopped;
  std::string solver;                 // "gram" or "qr"
  std::vector<std::string> warnings;  // whole sentences
  std::string better_start, twin;     // of these, that a scattered start found a better minimum,
                                      // and that another set of parameters fits as well
  Problem::Residuals residuals_fit, residuals_check;
};

Fit calibrate(const Program& program, const Recordings& recordings, const Split& split,
              const FitOptions& options);

// Bias, precision, RMSE of every row, with full-scale ranges `fsr` per row.
std::vector<Measure> measures(const Program& program, const Eigen::MatrixXd& raw,
                              const std::vector<double>& fsr);

// Per residual row: the range of the measured quantity over all recordings (internal units).
std::vector<double> full_scale_ranges(const Program& program, const Recordings& recordings);

}  // namespace talus
