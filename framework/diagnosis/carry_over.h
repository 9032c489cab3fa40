// Does a hypothesis predict rows that it was not fitted to? Asked within the rows to fit, where the
// stated noise makes the fit impossible: what is left there is not noise, neighbours misfit alike,
// and odds worked out as if rows were independent promise too much to whatever is flexible.
//
// Five folds, each of two runs of neighbours in the order of recording; each is predicted by fits
// to the others.
#pragma once

#include "framework/diagnosis/hypothesis.h"

namespace talus {

class CarryOver {
 public:
  explicit CarryOver(const Ground& ground);

  // Squares of each pose's whitened rows, predicted by the other folds.
  Eigen::VectorXd predicted(const Trial& trial) const;
  // Do the poses say that `more` predicts better than `less`? By their signed gains, at 1 %.
  static bool better(const Eigen::VectorXd& more, const Eigen::VectorXd& less);

 private:
  const Ground* ground_;
  std::vector<Split> folds_;
};

}  // namespace talus
