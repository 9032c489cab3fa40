// Fits of one model to copies of its recordings that were changed: quick ones to some of the rows,
// and full ones.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "framework/calibration/problem.h"
#include "framework/diagnosis/faults.h"

namespace talus {

// What a fit leaves; infinite where the model has no value.
struct FaultTrial {
  double left = std::numeric_limits<double>::infinity();   // twice the cost ...
  double rows = std::numeric_limits<double>::infinity();   // ... the rows' share of it, per degree
  double prior = std::numeric_limits<double>::infinity();  // and the priors', in all
  double share = std::numeric_limits<double>::infinity();  // of the measured range, of full trials
  std::vector<double> x;
};

// The squares of the distances from nominal, in tolerances.
double prior_squares(const Problem& problem, const std::vector<double>& x);

class FaultTrials {
 public:
  // rows: those to fit.
  FaultTrials(const Program& program, const Recordings& recordings, std::vector<std::size_t> rows,
              const FaultOptions& options);

  FaultTrial quick(const Recordings& r) { return of(r, few_, 12, false); }
  FaultTrial full(const Recordings& r) { return of(r, rows_, 60, true); }
  Problem problem(const Recordings& r) const { return problem(r, rows_); }  // of all rows
  int count = 0;

 private:
  Problem problem(const Recordings& r, const std::vector<std::size_t>& rows) const;
  FaultTrial of(const Recordings& r, const std::vector<std::size_t>& rows, int iterations,
                bool thorough);

  const Program& program_;
  std::vector<std::size_t> rows_, few_;
  std::uint64_t seed_;
  Groups groups_;
  ProblemOptions plain_;
  std::optional<Plan> plan_;
};

}  // namespace talus
