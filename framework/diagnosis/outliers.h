// Gross blunders: poses whose measurement is simply wrong, several at once perhaps, found without
// taking physics that was left out for blunders, nor letting blunders pass as physics.
//
// A blunder stands alone. So a pose is one only where
//   * it lies far outside the bulk of the poses: its deletion residual (what the fit to the other
//     poses fails to predict of it), squared in units of its own covariance,
//         d_k^2 = e_k^T (I - H_kk)^-1 e_k,     chi-square distributed for a good pose,
//     exceeds what the worst of so many good poses would show, in units of the bulk's own scale;
//     where physics was left out all poses misfit and that scale is large;
//   * its neighbours (in the order of recording, in each reading, in every other column) fit as the
//     others do: a step, a local bump, a session that was disturbed has neighbours of its own kind;
//   * others have what was recorded of it: where all poses approached from one side, and no others,
//     are far outside, that is play.
// Several blunders hide each other in a plain fit. The search therefore starts from least trimmed
// squares: of many fits to a few poses drawn at random, concentrated step by step on the poses that
// fit best, the one with the least spread. It works on the problem made linear; then the model is
// refitted without the suspects, made linear there, and every pose, suspects too, is judged anew,
// until nothing changes. Held-out rows take no part in that; they are judged by what is predicted.
//
// With physics found meanwhile, call it again with the extended model: the bulk's scale is then
// nearer to the noise, and smaller blunders are seen.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/kinematics/program.h"
#include "framework/recordings/recordings.h"

namespace talus {

struct OutlierOptions {
  int threads = 1;
  std::uint64_t seed = 1;
  bool held_out = true;  // judge the rows held out as well
};

struct Outlier {
  std::size_t row = 0;    // of the recordings
  int pose = 0;           // its number in the column `pose`; row + 1 without such a column
  bool held_out = false;  // among Split::check
  double sigmas = 0;      // d, in stated sigmas (in units of the bulk's scale where none is stated)
  double beyond = 0;      // d over the limit, > 1
  std::vector<double> off;  // of each residual row: measured minus predicted, internal units
  std::string statement;    // "pose 51 is off by 0.412 mm in E.x, ..."
};

struct Outliers {
  std::vector<Outlier> found;  // by row
  double scale = 1;            // misfit of the bulk over the stated noise
  std::size_t clustered = 0;   // poses far outside the bulk, but among neighbours of their kind
  std::size_t judged = 0;
  std::vector<double> x;  // the fit without them; the one given where nothing was found
  std::string statement;  // empty where nothing was found

  std::vector<std::size_t> keep(const std::vector<std::size_t>& rows) const;  // without those found
};

// x: the solution of a calibration of the program to the rows to fit (Fit::x).
Outliers find_outliers(const Program& program, const Recordings& recordings, const Split& split,
                       std::span<const double> x, const OutlierOptions& options = {});

}  // namespace talus
